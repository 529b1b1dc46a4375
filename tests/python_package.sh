#!/usr/bin/env bash
# Tests of the Python package with the python3 of the system; 77 where it has no numpy. Usage: tests/python_package.sh [PROGRAM]
set -euo pipefail
cd "$(dirname "$0")/../python"
for python in /usr/bin/python3 python3; do
  command -v "$python" >/dev/null && "$python" -c 'import numpy' 2>/dev/null && break
  python=
done
[ -n "$python" ] || { echo "skipped: python3 has no numpy (apt-get install python3-numpy)"; exit 77; }
if "$python" -c 'import mypy' 2>/dev/null; then
  "$python" -m mypy --strict --cache-dir /dev/null aligngs  # types, where Debian's mypy is
fi
[ $# -eq 0 ] || export ALIGNGS=$1
PYTHONPATH="$PWD:$PWD/tests" exec "$python" -B -m unittest discover -s tests
