#!/usr/bin/env bash
# install-library.sh LIBOFC.SO FOLDER: puts the shared library there under its SONAME, with the link for linking.
set -euo pipefail
soname=$(objdump -p "$1" | awk '$1 == "SONAME" { print $2 }')
mkdir -p "$2"
cp "$1" "$2/$soname"
ln -sf "$soname" "$2/libofc.so"
