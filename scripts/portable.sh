#!/usr/bin/env bash
# Makes a tar.gz that runs without an installation and without root on Debian 12 and on Ubuntu 22.04 and 24.04.
# Usage: scripts/portable.sh [BUILD-FOLDER]     result: dist/aligngs-VERSION-linux-x86_64.tar.gz
# The libraries of Debian travel with the program. Those of the C and C++ compilers are the system's: they must be of
# GCC 12 and glibc 2.35 or later, which this script checks.
set -euo pipefail
cd "$(dirname "$0")/.."
case "${1:-}" in -h|--help) sed -n '2,5p' "$0" | cut -c3-; exit 0 ;; esac
folder=${1:-build}
newest_glibc=2.35 # of Ubuntu 22.04, the oldest of the three
command -v patchelf >/dev/null || { echo "portable.sh: patchelf is missing: apt-get install patchelf" >&2; exit 5; }
if [ ! -x "$folder/aligngs" ]; then
  scripts/build.sh "$folder" -DCMAKE_BUILD_TYPE=Release -DALIGNGS_BUILD_TESTS=OFF -DALIGNGS_BUILD_BENCHMARKS=OFF -DALIGNGS_UNITY_BUILD=ON
fi
version=$("$folder/aligngs" --version | awk '{print $2}')
name=aligngs-$version-linux-$(uname -m)
mkdir -p dist
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
place=$work/$name
cmake --install "$folder" --prefix "$place" --strip >/dev/null
mkdir -p "$place/lib"

# glibc and the run-time of GCC belong to the system: two versions of them in one process do not work.
ldd "$place/bin/aligngs" | awk '/=> \//{print $3}' |
  grep -vE '/(ld-linux[^/]*|lib(c|m|dl|rt|pthread|resolv|stdc\+\+|gcc_s)\.so[^/]*)$' |
  while read -r library; do
    cp -L "$library" "$place/lib/"
    strip --strip-unneeded "$place/lib/$(basename "$library")" 2>/dev/null || true
    file=$(realpath "$library")
    # Some packages list their files below /lib, which is /usr/lib.
    { dpkg-query -S "$file" "${file#/usr}" 2>/dev/null || true; } | head -n 1 | cut -d: -f1
  done | sort -u >"$work/packages"
chmod 644 "$place"/lib/*
# RPATH, not RUNPATH, so that it also holds for the libraries' own libraries.
patchelf --force-rpath --set-rpath "\$ORIGIN/../lib" "$place/bin/aligngs"
for library in "$place"/lib/*; do patchelf --force-rpath --set-rpath "\$ORIGIN" "$library"; done
mkdir -p "$place/share/doc/aligngs/libraries"
while read -r package; do
  cp -L "/usr/share/doc/$package/copyright" "$place/share/doc/aligngs/libraries/$package" 2>/dev/null ||
    { echo "portable.sh: the licence of $package is missing" >&2; exit 1; }
done <"$work/packages"

wanted=$(for file in "$place"/bin/aligngs "$place"/lib/*; do objdump -T "$file" 2>/dev/null | grep -o 'GLIBC_2\.[0-9]*'; done |
         sed 's/GLIBC_//' | sort -Vu | tail -n 1)
if [ "$(printf '%s\n' "$wanted" $newest_glibc | sort -V | tail -n 1)" != $newest_glibc ]; then
  echo "portable.sh: something needs glibc $wanted, newer than $newest_glibc of Ubuntu 22.04" >&2
  exit 1
fi
tar --owner=0 --group=0 --sort=name -C "$work" -czf "dist/$name.tar.gz" "$name"
ls -l "dist/$name.tar.gz"
