#!/usr/bin/env bash
# install_dependencies.sh [GROUP...]: installs what is missing from Debian 12, and from npm what the
# page of reports is made of.
#   build  compiler and libraries (openimageio-tools: the CMake files of the library ask for them),
#          Node.js for npm, three.js
#   demo   jq, to read the report
#   test   Chromium and Blender, outside readers of what we write
#   check  clang-format and clang-tidy
# Asks for nothing when everything is there already; uses sudo only when not root.
set -euo pipefail

build=(cmake ninja-build g++
       libopenmesh-dev libeigen3-dev libspectra-dev libceres-dev libsuitesparse-dev libopenblas-dev
       libtinygltf-dev libopenimageio-dev openimageio-tools libcli11-dev libfmt-dev libspdlog-dev nlohmann-json3-dev
       libtbb-dev libnanoflann-dev libexpected-dev libboost-dev libgtest-dev libgmock-dev
       libbenchmark-dev)
demo=(jq)
test=(chromium blender)
check=(clang-format clang-tidy)
# Node.js may come from elsewhere than Debian; then its package is not asked for.
command -v node >/dev/null && command -v npm >/dev/null || build+=(nodejs npm)

wanted=()
for group in "${@:-build}"; do
  case "$group" in
    build) wanted+=("${build[@]}") ;;
    demo) wanted+=("${demo[@]}") ;;
    test) wanted+=("${test[@]}") ;;
    check) wanted+=("${check[@]}") ;;
    *) echo "install_dependencies.sh: unknown group '$group'" >&2; exit 2 ;;
  esac
done

missing=()
for package in "${wanted[@]}"; do
  status=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$status" = installed ] || missing+=("$package")
done
if [ ${#missing[@]} -gt 0 ]; then
  echo "installing from Debian: ${missing[*]}" >&2
  as_root=()
  [ "$(id -u)" -eq 0 ] || as_root=(sudo)
  export DEBIAN_FRONTEND=noninteractive
  "${as_root[@]}" apt-get update -qq
  "${as_root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >&2
fi

viewer=$(dirname "${BASH_SOURCE[0]}")/viewer
case " ${*:-build} " in
  *" build "*)
    # npm writes this file last; it is older than the wanted versions after an update.
    if [ ! "$viewer/node_modules/.package-lock.json" -nt "$viewer/package-lock.json" ]; then
      echo "installing from npm: three.js" >&2
      (cd "$viewer" && npm ci --no-audit --no-fund --loglevel=error >&2)
    fi ;;
esac
