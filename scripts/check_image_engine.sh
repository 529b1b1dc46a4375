#!/usr/bin/env bash
# Builds the stage "cpu" of the Dockerfile with Debian's buildah, and runs the program in it as its ordinary user.
# Usage: scripts/check_image_engine.sh [DEB | --source]     needs root, debootstrap and unshare; 77 where one is missing
# No registry is asked: the base comes from debootstrap, and DEB takes the place of the stage "build". With --source
# that stage runs too, on the files of the last commit. It compiles everything, and needs 10 GB.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/clean_root.sh
case "${1:-}" in -h|--help) sed -n '2,5p' "$0" | cut -c3-; exit 0 ;; esac
[ "${1:-}" = --source ] || deb=$(package_in_dist 'aligngs_*.deb' package.sh "${1:-}")
clean_root_or_skip
command -v unshare >/dev/null || { echo "skipped: unshare is missing (apt-get install util-linux)"; exit 77; }
make_clean_root

# --- A folder as `docker build` sees it. Without --source its stage "build" only hands on the package.
context=$root/context
mkdir -p "$context/dist" "$root/volume"
if [ "${1:-}" = --source ]; then
  git archive HEAD | tar -C "$context" -x
  sed -n '/^FROM debian:12 AS build$/,/^# The toolkit/p' Dockerfile >"$context/Dockerfile"
else
  cp "$deb" "$context/dist/"
  cp -r scripts "$context/"
  { printf 'FROM scratch AS build\nCOPY dist /src/dist\n\n'; sed -n '/^FROM .* AS cpu-files$/,/^# The toolkit/p' Dockerfile; } >"$context/Dockerfile"
fi
chown 1000:1000 "$root/volume"
tar -C "$root" --exclude='./proc/*' --exclude=./context --exclude=./volume -cf "$root.base" .
mv "$root.base" "$root/base.tar"

inside apt-get update -qq
inside env DEBIAN_FRONTEND=noninteractive apt-get install -qq -y --no-install-recommends buildah ca-certificates >/dev/null
mkdir -p "$root/etc/containers"
echo '{"default": [{"type": "insecureAcceptAnything"}]}' >"$root/etc/containers/policy.json" # all images are made here

cat >"$root/build.sh" <<'STEPS'
set -eu
export STORAGE_DRIVER=vfs BUILDAH_ISOLATION=chroot # these two work inside of other containers
base=$(buildah from scratch)
buildah add -q "$base" /base.tar / >/dev/null
buildah commit -q --rm "$base" docker.io/library/debian:12-slim >/dev/null
buildah tag docker.io/library/debian:12-slim docker.io/library/debian:12
rm /base.tar
buildah bud -q --pull-never --target cpu -t aligngs /context >/dev/null
user=$(buildah inspect --type image --format '{{.OCIv1.Config.User}}' aligngs)
[ "$user" = 1000 ] || { echo "check_image_engine.sh: the image has the user '$user', not 1000" >&2; exit 1; }
container=$(buildah from --pull-never aligngs)
in_it() { buildah run -v /volume:/data "$container" -- "$@"; }
in_it aligngs --version
in_it aligngs demo -q -n 30 --views 8 --size 64x48 -o run
in_it id
echo "$(du -sm "$(buildah mount "$container")" | cut -f1) MB" >/size
STEPS
# shellcheck disable=SC2016
unshare --mount --propagation private sh -c '
  mount --bind "$1" "$1" && mount --rbind /dev "$1/dev" && mount --rbind /sys "$1/sys"
  mount -t proc proc "$1/proc" && exec chroot "$1" sh /build.sh' sh "$root"
owner=$(stat -c %u "$root/volume/run/report.html") || { echo "check_image_engine.sh: there is no report" >&2; exit 1; }
[ "$owner" = 1000 ] || { echo "check_image_engine.sh: the report belongs to uid $owner, not 1000" >&2; exit 1; }
echo "check_image_engine.sh: $(inside buildah --version | cut -d' ' -f1-3) builds the image and runs its demo as uid 1000; $(cat "$root/size")"
