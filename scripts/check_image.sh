#!/usr/bin/env bash
# Runs the steps of the Dockerfile's stages "cpu-files" and "cpu" in a clean Debian 12, without a container engine, and
# then the program as its ordinary user with a read-only root and one volume.
# Usage: scripts/check_image.sh [DEB]     needs root, debootstrap and unshare; 77 where one is missing
# DEB takes the place of the stage "build", which is scripts/setup.sh, scripts/build.sh and scripts/package.sh.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/clean_root.sh
case "${1:-}" in -h|--help) sed -n '2,5p' "$0" | cut -c3-; exit 0 ;; esac
deb=$(package_in_dist 'aligngs_*.deb' package.sh "${1:-}")
clean_root_or_skip
command -v unshare >/dev/null || { echo "skipped: unshare is missing (apt-get install util-linux)"; exit 77; }
make_clean_root

# --- The steps, in their order.
user= folder=/ entry= image= environment=()
while read -r word rest; do
  case "$word" in
    ENV) for pair in $rest; do environment+=("$pair"); done ;;
    WORKDIR) folder=$rest; mkdir -p "${image:-$root}$rest" ;;
    USER) user=$rest ;;
    ENTRYPOINT) entry=$(sed 's/^\["\(.*\)"\]$/\1/' <<<"$rest") ;;
    COPY)
      case "$rest" in
        "--from=build /src/dist /tmp/dist") mkdir -p "$root/tmp/dist"; cp "$deb" "$root/tmp/dist/" ;;
        "--from=cpu-files /image /") image=$root/image ;;
        scripts/*) cp "${rest% *}" "$root${rest#* }" ;;
        *) echo "check_image.sh: this COPY is not known: $rest" >&2; exit 1 ;;
      esac ;;
    RUN)
      echo "RUN $rest" | cut -c1-120
      inside env DEBIAN_FRONTEND=noninteractive "${environment[@]}" sh -c "cd '$folder' && $rest" >"$root.log" 2>&1 ||
        { tail "$root.log" >&2; rm -f "$root.log"; exit 1; }
      rm -f "$root.log" ;;
    CMD|"") ;;
    *) echo "check_image.sh: this step is not known: $word" >&2; exit 1 ;;
  esac
done < <(sed -n '/^FROM .* AS cpu-files$/,/^FROM .* AS build-cuda/p' Dockerfile | grep -v '^FROM \|^#')
[ -n "$image" ] || { echo "check_image.sh: the stage cpu takes no files" >&2; exit 1; }
[ "$user" = 1000 ] || { echo "check_image.sh: the stage has no ordinary user" >&2; exit 1; }
size=$(du -sm "$image" | cut -f1)
packed=$(tar -C "$image" -c . | gzip -1 | wc -c)
largest=200 # MB
[ "$size" -le $largest ] || { echo "check_image.sh: the image has $size MB, more than $largest" >&2; exit 1; }

# --- A container: the root read-only, /data a volume, /tmp in memory.
volume=$(mktemp -d)
chown 1000:1000 "$volume"
as_container() {
  unshare --mount --pid --fork --kill-child sh -c '
    root=$1 volume=$2 folder=$3; shift 3
    mount --bind "$root" "$root" && mount -o remount,bind,ro "$root"
    mount --bind "$volume" "$root/data"
    mount -t tmpfs tmpfs "$root/dev" # as engines make it
    for device in null zero random urandom; do touch "$root/dev/$device"; mount --bind "/dev/$device" "$root/dev/$device"; done
    mount -t tmpfs tmpfs "$root/tmp" && mount -t proc proc "$root/proc"
    exec chroot --userspec=1000:1000 "$root" sh -c "cd \"\$0\" && exec \"\$@\"" "$folder" "$@"' \
    sh "$image" "$volume" "$folder" env HOME=/tmp "${environment[@]}" "$@"
}
if as_container sh -c 'touch /usr/x 2>/dev/null'; then echo "check_image.sh: the root is not read-only" >&2; exit 1; fi
as_container "$entry" --version
as_container "$entry" demo -q -n 30 --views 8 --size 64x48 -o run
printf 'one\tdemo\t-n 10 --views 8 --size 64x48\n' >"$volume/rooms.tsv"
as_container env JOB_COMPLETION_INDEX=0 "$entry" batch /data/rooms.tsv -o /data/rooms --shards 1 -q # as a pod of the manifest
status=0
[ -s "$volume/run/report.html" ] && [ -s "$volume/rooms/rooms/one/report.html" ] || status=1
rm -rf "$volume"
[ $status -eq 0 ] || { echo "check_image.sh: a report is missing" >&2; exit 1; }
echo "check_image.sh: the steps run, and the program works as uid 1000 with a read-only root; $size MB, $((packed / 1000000)) MB compressed"
