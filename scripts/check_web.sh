#!/usr/bin/env bash
# Checks the types of the page, builds it, and compares it with the committed web/dist. Installs what its tests need
# (web/node_modules, tests/node/node_modules). Usage: scripts/check_web.sh     Without node or the npm registry: a message.
set -euo pipefail
cd "$(dirname "$0")/.."
if ! command -v npm >/dev/null; then
  echo "web: skipped, npm is not installed (scripts/setup.sh --browser)" >&2
  exit 0
fi
for folder in web tests/node; do
  # Installed already, and from this very lock file: nothing to fetch.
  if cmp -s "$folder/package-lock.json" "$folder/node_modules/.aligngs-lock"; then continue; fi
  if ! npm --prefix "$folder" ci --no-audit --no-fund --loglevel=error; then
    if npm ping >/dev/null 2>&1; then exit 1; fi
    echo "web: skipped, the npm registry cannot be reached" >&2
    exit 0
  fi
  cp "$folder/package-lock.json" "$folder/node_modules/.aligngs-lock"
done
npm --prefix web run --silent check
built=$(mktemp -d)
trap 'rm -rf "$built"' EXIT
(cd web && node build.mjs "$built")
if ! diff -r "$built" web/dist >/dev/null; then
  echo "web: web/dist is not what web/src gives; run 'npm run build' in web/ and commit it" >&2
  exit 1
fi
echo "web: ok"
