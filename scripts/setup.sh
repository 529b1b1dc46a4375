#!/usr/bin/env bash
# Installs what building and testing aligngs needs, from Debian 12 or Ubuntu packages.
# Usage: scripts/setup.sh [--clang] [--browser] [--python] [--packages] [--format]
#   --clang     clang 14 and the fuzzing runtime
#   --browser   for tests of the page, of exports, plans and videos: chromium, node, npm, ffmpeg and readers of files
#   --python    for tests of the Python package and of the Kubernetes manifest: numpy, PyYAML, jsonschema, mypy
#   --packages  for making packages and installing them in a clean Debian: dpkg-dev, file, patchelf, debootstrap
#   --format    clang-format-14, which scripts/format.sh runs
set -euo pipefail

packages=(
  build-essential cmake ninja-build git pkg-config ccache python3
  libcli11-dev libspdlog-dev libfmt-dev nlohmann-json3-dev libtomlplusplus-dev
  libturbojpeg0-dev libspng-dev libwebp-dev libheif-dev libexif-dev zlib1g-dev
  libeigen3-dev libhwy-dev libnanoflann-dev libembree-dev libmeshoptimizer-dev
  libgtest-dev libgmock-dev libbenchmark-dev libdnnl-dev libboost-dev
  libcurl4-openssl-dev
)
for option in "$@"; do
  case "$option" in
    --clang) packages+=(clang-14 libclang-rt-14-dev) ;;
    --browser)
      packages+=(chromium assimp-utils fonts-dejavu-core ffmpeg libxml2-utils librsvg2-bin python3-ezdxf poppler-utils)
      # A node that came from elsewhere brings its own npm and conflicts with Debian's.
      command -v node >/dev/null || packages+=(nodejs)
      command -v npm >/dev/null || packages+=(npm)
      ;;
    --python) packages+=(python3-numpy python3-yaml python3-jsonschema mypy) ;;
    --packages) packages+=(dpkg-dev file patchelf debootstrap) ;;
    --format) packages+=(clang-format-14) ;;
    -h|--help) sed -n '2,8p' "$0" | cut -c3-; exit 0 ;;
    *) echo "setup.sh: unknown option $option" >&2; exit 2 ;;
  esac
done

# Ubuntu names the TurboJPEG headers libturbojpeg0-dev as well; an installed package costs nothing to ask for.
missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then
  exit 0
fi

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || { echo "setup.sh: run me as root, or install sudo; I need: ${missing[*]}" >&2; exit 5; }
  as_root=(sudo)
fi
echo "setup.sh: installing ${missing[*]}" >&2
"${as_root[@]}" apt-get update -qq
DEBIAN_FRONTEND=noninteractive "${as_root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
