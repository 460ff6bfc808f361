#!/usr/bin/env bash
# Builds the wheel, installs it into target/python, and tests it: pytest, mypy and ruff. OFC_DATA is the folder of photographs, if any.
set -euo pipefail
cd "$(dirname "$0")"
venv=../../target/python
[ -x "$venv/bin/pip" ] || python3 -m venv "$venv"
"$venv/bin/pip" install --quiet --disable-pip-version-check '.[dask,files,plot,test]'
"$venv/bin/ruff" format --quiet --check .
"$venv/bin/ruff" check --quiet .
"$venv/bin/mypy" src tests
"$venv/bin/pytest" "$@"
