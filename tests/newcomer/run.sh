#!/usr/bin/env bash
# What a newcomer does, from a clone to the normals of a picture, in each way that README names: c.sh, cpp.sh and so on are the
# commands, at most ten each, for an empty folder with README's programs and a picture. Says how long each way took.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
clone=$(cd "$here/../.." && pwd)
export clone
# shellcheck source-path=SCRIPTDIR source=../../.ci/packages.sh
. "$clone/.ci/packages.sh"
# What Rust's way compiles of others is kept.
export CARGO_TARGET_DIR=$clone/target/newcomer
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# program LANGUAGE: README's program in it.
program() {
    awk -v fence="\`\`\`$1" '$0 == fence && !found { inside = found = 1; next } /^```$/ { inside = 0 } inside' "$clone/README.md"
}

python3 "$here/ball.py" make "$work"
ways=(c cpp fetch rust debian)
if reaches_pypi; then
    ways+=(python)
fi
for way in "${ways[@]}"; do
    began=$SECONDS folder=$work/$way
    # The wheel is that of the tests before, or nearly.
    [ "$way" != python ] || export CARGO_TARGET_DIR=$clone/target
    mkdir "$folder"
    cp "$work"/ball.{rgb,png} "$folder"
    for language in c cpp python; do
        program $language >"$folder/normals.${language/python/py}"
    done
    program rust,no_run >"$folder/normals.rs"
    # A program of several lines is one command.
    commands=$(sed -e '/^#/d' -e "/^echo '/,/'/c command" "$here/$way.sh" | wc -l)
    [ "$commands" -le 10 ] || { echo "newcomer: $way takes $commands commands" >&2; exit 1; }
    (cd "$folder" && bash -eux "$here/$way.sh") >"$work/$way.log" 2>&1 || { cat "$work/$way.log" >&2; exit 1; }
    if [ -f "$folder/normals.png" ]; then
        python3 "$clone/tests/picture.py" "$folder/normals.png" 640 480
    else
        (cd "$folder" && python3 "$here/ball.py" check normals.f32)
    fi
    # Whatever the language, the bits are those of C.
    [ ! -f "$folder/normals.f32" ] || cmp "$work/c/normals.f32" "$folder/normals.f32"
    echo "newcomer: $way took $commands commands and $((SECONDS - began)) s"
done
