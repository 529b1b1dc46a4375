#!/usr/bin/env bash
# Measures README, docs, help texts and comments by the rules of CONTRIBUTING.md.
# Usage: scripts/check_prose.sh [--table] [FILE...]     --table prints words, sentence length and numbers
set -euo pipefail
cd "$(dirname "$0")/.."
exec python3 -B scripts/prose.py "$@"
