#!/usr/bin/env bash
# Measures README, docs and help texts by the rules of CONTRIBUTING.md.
# Usage: scripts/check_prose.sh [--table] [FILE...]     --table prints words, sentence length and numbers per file
set -euo pipefail
cd "$(dirname "$0")/.."
exec python3 -B scripts/prose.py "$@"
