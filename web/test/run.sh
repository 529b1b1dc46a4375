#!/bin/sh
# One test of the page, as ctest calls it. Usage: run.sh TEST PROGRAM INPUT SCREENSHOTS. Status 77: skipped, with the reason.
here=$(cd "$(dirname "$0")" && pwd)
command -v node >/dev/null || { echo "skipped: node is not installed (scripts/setup.sh --browser)"; exit 77; }
[ -d "$here/../node_modules/playwright-core" ] || { echo "skipped: playwright-core is not installed (npm ci in web/)"; exit 77; }
test=$1
shift
cd "$here/.." && exec node "test/$test.mjs" "$@"
