#!/usr/bin/env bash
# Builds ofc.wasm, the package and the page into dist/, and tests them. Needs node, npm and clang, Rust's target wasm32-unknown-unknown
# (rustup target add), bindings/python/test.sh before it, and for the page a Chromium: CHROMIUM names it. dist/shots has pictures of the page.
set -euo pipefail
cd "$(dirname "$0")"
root=$(cd ../.. && pwd)
# 300 KB over the wire, which every phone takes.
most_bytes=307200

CARGO_PROFILE_RELEASE_STRIP=true cargo build --quiet --release -p ofc-ffi --target wasm32-unknown-unknown --target-dir "$root/target"
npm ci --silent --no-audit --no-fund
npx tsc -p tsconfig.build.json
node trim.mjs "$root/target/wasm32-unknown-unknown/release/ofc.wasm" dist/ofc.wasm dist/index.js
bytes=$(gzip -9 -c dist/ofc.wasm | wc -c)
echo "ofc.wasm: $bytes bytes over the wire"
[ "$bytes" -le "$most_bytes" ] || { echo "ofc.wasm: more than $most_bytes bytes" >&2; exit 1; }

npx tsc --noEmit
npx vite build page --logLevel warn
node test/layout.mjs | clang --target=wasm32 -xc -std=c11 -ffreestanding -fsyntax-only "-I$root/include" -

# The same picture through the native library.
python3 "$root/tests/newcomer/ball.py" make dist
native=$("$root/target/python/bin/python" - dist/ball.rgb <<'END'
import hashlib
import sys
import numpy as np
import orientation_from_color as ofc

normals = ofc.solve(np.fromfile(sys.argv[1], np.uint8).reshape(480, 640, 3)).normals()
print(hashlib.sha256(normals.tobytes()).hexdigest(), ofc.__version__)
END
)
OFC_BALL=dist/ball.rgb OFC_NORMALS_SHA256=${native% *} OFC_VERSION=${native#* } node --test test/package.test.mjs
chromium=${CHROMIUM:-$(command -v chromium || true)}
[ -n "$chromium" ] || { echo "no Chromium: the page was not tried" >&2; exit 1; }
node test/page.mjs "$chromium" dist/ball.png dist/shots
