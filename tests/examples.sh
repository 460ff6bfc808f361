#!/usr/bin/env bash
# Runs the examples as a user would, and looks at what they say and write.
set -euo pipefail
cd "$(dirname "$0")/.."
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

fail() {
    echo "examples: $*" >&2
    exit 1
}

# expect STATUS COMMAND...: runs it, and keeps what it says in $out/said.
expect() {
    local expected=$1 status=0
    shift
    "$@" >"$out/said" 2>&1 || status=$?
    [ "$status" -eq "$expected" ] || { cat "$out/said" >&2; fail "$* ended with $status, not $expected"; }
}

# says TEXT: the last command said so.
says() {
    grep -qF -- "$1" "$out/said" || { cat "$out/said" >&2; fail "nothing was said of '$1'"; }
}

# json FILE EXPRESSION: a Python expression over the report r holds.
json() {
    python3 -c 'import json, sys; r = json.load(open(sys.argv[1])); sys.exit(not eval(sys.argv[2]))' "$1" "$2" ||
        fail "$1: not $2"
}

expect 0 ./c_examples/run.sh --out "$out/scene"
says "median error"
for file in normals.png normals.tiff inliers.png report.json overview.png depth.tiff depth.png mesh.ply uncertainty.tiff \
    uncertainty.png; do
    [ -s "$out/scene/$file" ] || fail "no $file"
done
json "$out/scene/report.json" 'r["status"] == "success" and r["median_error_deg"] < 10'
json "$out/scene/report.json" '0.1 < r["uncertainty"]["median_deg"] < 20 and len(r["uncertainty"]["covariance_of_F"]) == 9'
says "1 sigma"
json "$out/scene/report.json" 'all(k in r for k in "coefficients C r_squared dispersion inliers norm_location norms cosines tilt_deg slant_deg candidates F ms version".split())'
json "$out/scene/report.json" 'all(k in c for c in r["coefficients"] for k in ("value", "standard_error", "t", "p"))'

# The mesh opens in other programs, with the size that the report says.
assimp info "$out/scene/mesh.ply" >"$out/mesh" || fail "assimp cannot read mesh.ply"
json "$out/scene/report.json" 'r["depth"]["converged"] and r["depth"]["residual"] <= 1e-4'
json "$out/scene/report.json" "r['depth']['range'][0] < -30 and abs(r['depth']['range'][0] - $(sed -n 's/Minimum point .* \(.*\))/\1/p' "$out/mesh")) < 1e-3"

photo=target/c_examples/ofc_photo
expect 0 "$photo" --help
says "--planes"
expect 2 "$photo" --no-such-option
expect 2 "$photo" "$out/no-such-file.png"
says "cannot read"
expect 2 "$photo" "$out/scene/inliers.png" --out "$out/gray"
says "grayscale"
expect 2 "$photo" --mask "$out/scene/inliers.png"
expect 2 "$photo" --planes "$out/scene/inliers.png"
expect 2 "$photo" "$out/scene/overview.png" --mask "$out/scene/inliers.png"
says "the mask is"
expect 2 "$photo" "$out/scene/normals.png" --out /dev/null/x
expect 2 "$photo" --seed many
expect 2 "$photo" --integrate frankot
expect 2 "$photo" --pixel-pitch 0
# A normal map is no picture of a matte surface: refused or not, but with an answer and its own results.
expect 0 "$photo" "$out/scene/normals.png" --truth "$out/scene/normals.tiff" --subsets 600 --seed 7 --out "$out/again"
json "$out/again/report.json" 'r["parameters"] == {"seed": 7, "subsets": 600, "fit": "median"} and "median_error_deg" in r'

# The TIFF holds plain floats and reads back as what was written.
python3 tests/plain_tiff.py "$out/again/normals.tiff" || fail "normals.tiff is compressed"
expect 0 "$photo" "$out/scene/normals.png" --truth "$out/again/normals.tiff" --subsets 600 --seed 7 --out "$out/third"
json "$out/third/report.json" 'r["median_error_deg"] < 0.001'

# Table 1 beside the paper's own errors, on its kind of scene.
table1=target/c_examples/ofc_table1
expect 0 "$table1" --out "$out/table1"
says "channel maxima"
for file in depth.png color.png inliers.png curves.png integral.png shaded_truth.png shaded_result.png angular_error.png \
    gray_error.png overview.png table1.json; do
    [ -s "$out/table1/$file" ] || fail "no $file"
done
json "$out/table1/table1.json" 'r["median_error_deg"]["OFC"] < 21.51 and r["median_error_deg"]["OFC (correct tilts)"] < 16.80'
json "$out/table1/table1.json" 'r["median_error_deg"]["best orthogonal matrix"] == min(r["median_error_deg"].values())'
json "$out/table1/table1.json" 'abs(r["branch"]["solution_slant_deg"] - r["table"][3]["values"][0]) < 1e-6'
json "$out/table1/table1.json" 'len(r["median_error_deg"]) == 6 and all(r["median_error_deg"].values())'
json "$out/table1/table1.json" '[round(v, 2) for v in r["table"][0]["values"]] == [-36.79, -149.91, -136.55]'
json "$out/table1/table1.json" '[round(v, 2) for v in r["table"][2]["values"]] == [23.26, 30.63, 10.87]'
expect 0 "$table1" "$out/scene/depth.tiff" --noise 0 --out "$out/table1_tiff"
json "$out/table1_tiff/table1.json" 'r["noise"] == 0 and r["inliers"] > 30000'
# A map of 16 bits, in units of its own: without them the surface is a needle. A flat one has no rank, and an end.
python3 tests/dome_png.py "$out/dome.png" 1
expect 0 "$table1" "$out/dome.png" --pixel-pitch 200 --out "$out/table1_png"
json "$out/table1_png/table1.json" 'r["inliers"] > 7000 and r["median_error_deg"]["OFC (correct tilts)"] < 4'
expect 1 "$table1" "$out/dome.png" --out "$out/table1_png"
python3 tests/dome_png.py "$out/flat.png" 0
expect 1 timeout 60 "$table1" "$out/flat.png" --out "$out/table1_flat"
says "rank-deficient"
[ -s "$out/table1_flat/overview.png" ] || fail "a flat range map without an overview"
expect 2 "$table1" "$out/no-such-file.tiff"
expect 2 "$table1" "$out/scene/normals.tiff"
says "neither"
expect 2 "$table1" --noise -1

# Table 2 and section 5's checks of any photograph.
expect 0 "$photo" --report paper --out "$out/paper"
for line in "Lee-Rosenfeld" "correlation of input" "shaded depth" "coefficient"; do says "$line"; done
json "$out/paper/report.json" 'all(c > 0.98 for c in r["check"]["correlation"]) and r["rank"] == dict(r["rank"], colors=3, normals=3)'
json "$out/paper/report.json" 'all(abs(a) < 10 for a in r["check"]["depth"]["tilt_difference_deg"])'
expect 2 "$photo" --report long
expect 0 "$photo" --orientation direct --out "$out/paper"
json "$out/paper/report.json" 'r["confidence"]["evidence"] == "tilts alone" and r["candidates"]'
json "$out/scene/report.json" 'r["confidence"]["expected_error_deg"] < 8 and "trust" in r["confidence"]["in_words"]'
expect 2 "$photo" --orientation short
expect 2 "$photo" --fit mean

# Integration alone gives what ofc_photo gave, in millimetres, from floats; and nearly so from eight bits.
integrate=target/c_examples/ofc_integrate
expect 0 "$integrate" "$out/scene/normals.tiff" --pixel-pitch 0.5 --out "$out/depth"
says "median angle"
for file in depth.tiff depth.png mesh.png mesh.ply report.json; do
    [ -s "$out/depth/$file" ] || fail "no $file"
done
range='(r["range"][1] - r["range"][0])'
span=$(python3 -c 'import json, sys; r = json.load(open(sys.argv[1]))["depth"]["range"]; print(r[1] - r[0])' "$out/scene/report.json")
json "$out/depth/report.json" "r['unit'] == 'mm' and abs($range / $span - 0.5) < 1e-3"
expect 0 "$integrate" "$out/scene/normals.png" --mask "$out/scene/inliers.png" --out "$out/depth8"
json "$out/depth8/report.json" "abs($range / $span - 1) < 0.05 and r['median_angle_deg'] < 3"
expect 0 "$integrate" "$out/scene/normals.png" --integrate coupled --known "$out/scene/depth.tiff" --tolerance 1e-3 --out "$out/depth8"
json "$out/depth8/report.json" 'r["method"] == "coupled"'
expect 0 "$integrate" "$out/scene/normals.png" --y-down --integrate paper --out "$out/depth8"
json "$out/depth8/report.json" 'r["method"] == "paper"'
expect 2 "$integrate"
expect 2 "$integrate" "$out/no-such-file.tiff"
expect 2 "$integrate" "$out/scene/inliers.png" --out "$out/depth8"
says "neither"
expect 2 "$integrate" "$out/scene/normals.png" --mask "$out/scene/overview.png"
expect 2 "$integrate" "$out/scene/normals.png" --known "$out/scene/normals.png"
expect 2 "$integrate" "$out/scene/normals.png" --integrate fast

expect 0 target/c_examples/minimal
says "mean error"

data=${OFC_DATA:-../shared/data}
if [ -d "$data" ]; then
    expect 0 "$photo" "$data/cat_figurine/rgb.png" --mask "$data/cat_figurine/mask.png" --out "$out/cat"
    json "$out/cat/report.json" 'r["inliers"]["after_norms"] > 80000'
    # Near lights: divided by the gel alone, the ball of 9.5 mm is nearer to the truth.
    ball=$data/gelsight_ball_9mm
    expect 0 "$photo" "$ball/rgb.png" --background "$ball/background.png" --mask "$ball/mask.png" --out "$out/flat"
    says "divided"
    expect 2 "$photo" "$ball/rgb.png" --background "$data/cat_figurine/rgb.png" --out "$out/flat"
    says "no background"
    # Photometric stereo with unknown lights: the same three pictures as planes, by either fit.
    expect 0 "$photo" "$data/cat_figurine/rgb.png" --mask "$data/cat_figurine/mask.png" --save-planes --out "$out/planes"
    for fit in median squares; do
        expect 0 "$photo" --planes "$out/planes/plane_r.png" "$out/planes/plane_g.png" "$out/planes/plane_b.png" \
            --mask "$data/cat_figurine/mask.png" --truth "$out/cat/normals.tiff" --fit "$fit" --out "$out/stereo_$fit"
    done
    json "$out/stereo_median/report.json" 'r["median_error_deg"] < 0.001'
    json "$out/stereo_squares/report.json" 'r["parameters"]["fit"] == "squares" and r["median_error_deg"] < 15'
    expect 1 "$photo" "$data/gelsight_groove_rank2/rgb.png" --mask "$data/gelsight_groove_rank2/mask.png" --out "$out/groove"
    says "dimensions"
    [ -s "$out/groove/report.json" ] || fail "a refusal without a report"
    [ ! -e "$out/groove/depth.tiff" ] || fail "a refusal with depth"
else
    echo "skipped: no photographs beside the project (set OFC_DATA to their folder)"
fi
echo "examples: all as expected"
