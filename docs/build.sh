#!/usr/bin/env bash
# Builds this documentation into target/docs/html, without a warning, and runs the guide's programs. Needs doxygen, and
# bindings/python/test.sh before it, whose target/python has the package.
set -euo pipefail
cd "$(dirname "$0")"
root=$(cd .. && pwd) out=$(cd .. && pwd)/target/docs venv=$(cd .. && pwd)/target/python
mkdir -p "$out/doxygen"
"$venv/bin/pip" install --quiet --disable-pip-version-check -r requirements.txt
MPLBACKEND=Agg "$venv/bin/pytest" -q -p no:cacheprovider .

doxygen - <<END
INPUT=$root/include/ofc.h $root/include/ofc.hpp
OUTPUT_DIRECTORY=$out/doxygen
GENERATE_XML=YES
GENERATE_HTML=NO
GENERATE_LATEX=NO
PREDEFINED=CV_VERSION __cplusplus=201703L
EXCLUDE_SYMBOLS=ofc::detail
INPUT_FILTER="sed -f for_breathe.sed"
QUIET=YES
WARN_AS_ERROR=FAIL_ON_WARNINGS
END
RUSTDOCFLAGS="-D warnings" cargo doc --quiet --no-deps -p ofc-core --features full-streams
rm -rf "$out/extra" && cp -r "$root/target/doc" "$out/extra"
# Formulas without a network, where npm is there.
if command -v npm >/dev/null && npm install --silent --prefix "$out/npm" mathjax@3; then
    mkdir -p "$out/extra/mathjax"
    cp "$out/npm/node_modules/mathjax/es5/tex-svg.js" "$out/extra/mathjax"
fi
OFC_DOXYGEN=$out/doxygen/xml OFC_RUSTDOC=$out/extra "$venv/bin/sphinx-build" -W --keep-going -q -b html -d "$out/doctrees" . "$out/html"
echo "docs: $out/html/index.html"
