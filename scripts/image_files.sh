#!/bin/sh
# Copies what aligngs needs to run into an empty folder, which then is the whole root of an image: the program, the
# libraries it is linked to with their licences, a shell with a few tools, certificates, users. No package manager.
# Usage: scripts/image_files.sh FOLDER     runs as root in a Debian where the package is installed; the Dockerfile calls it
set -eu
to=$1
mkdir -p "$to/usr" "$to/etc/ssl/certs" "$to/proc" "$to/sys" "$to/dev" "$to/run" "$to/var/tmp"
mkdir -m 1777 "$to/tmp"
cp -a /bin /sbin /lib /lib64 "$to/"   # links into /usr
mkdir -p "$to/usr/bin" "$to/usr/sbin" "$to/usr/lib" "$to/usr/lib64"

programs=/usr/bin/aligngs
# /bin/sh is for Apptainer, and for people who look into a container; the others are for them and for scripts of jobs.
for tool in sh env cat cp date df head id ls mkdir mv rm sleep sync tail touch uname; do programs="$programs $(command -v $tool)"; done
for file in $programs; do
  cp -L "$file" "$to$file"
  echo "$file"
  # Lines "name => path (address)", and the loader as "path (address)".
  ldd "$file" | sed -n 's|.*=> \(/[^ ]*\) .*|\1|p; s|^[[:space:]]*\(/[^ ]*\) (.*|\1|p'
done | sort -u >"$to/files"
while read -r file; do
  [ -e "$to$file" ] || { mkdir -p "$to$(dirname "$file")"; cp -L "$file" "$to$file"; }
  # dpkg knows a file below /usr, or below the folder whose link leads there.
  real=$(realpath "$file")
  package=$({ dpkg-query -S "$real" "${real#/usr}" 2>/dev/null || true; } | head -n 1 | cut -d: -f1)
  [ -n "$package" ] || { echo "image_files.sh: no package has $file" >&2; exit 1; }
  mkdir -p "$to/usr/share/doc/$package"
  cp -L "/usr/share/doc/$package/copyright" "$to/usr/share/doc/$package/copyright" 2>/dev/null ||
    cp -L "/usr/share/doc/$package/LICENSE" "$to/usr/share/doc/$package/copyright"
done <"$to/files"
rm "$to/files"

cp -a /etc/passwd /etc/group /etc/nsswitch.conf /etc/os-release /etc/debian_version "$to/etc/"
mkdir -p "$to/usr/lib" && cp -L /usr/lib/os-release "$to/usr/lib/os-release"
cp -L /etc/ssl/certs/ca-certificates.crt "$to/etc/ssl/certs/"
ln -s certs/ca-certificates.crt "$to/etc/ssl/cert.pem"
cp -a /home /data "$to/"
