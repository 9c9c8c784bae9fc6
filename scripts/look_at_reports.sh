#!/bin/sh
# Runs some scenes, writes a page for each, tests the pages in Chromium with the network cut, and takes pictures
# of them to look at; their glTF files go through the Khronos validator. Needs Node 20, `npm ci` in tests/browser, and
# Chromium ($CHROMIUM, or on the path).
#
#     scripts/look_at_reports.sh FOLDER [SCENE...]
#
# writes FOLDER/runs, FOLDER/pages and FOLDER/pictures. AEROBOT is the program, `target/release/aerobot` if not
# said. Without scenes: those that show something of every kind.
set -eu

if [ $# -lt 1 ]; then
    echo "usage: $0 FOLDER [SCENE...]" >&2
    exit 2
fi
mkdir -p "$1"
folder=$(cd "$1" && pwd)
shift
cd "$(dirname "$0")/.."
aerobot=${AEROBOT:-target/release/aerobot}
heavy=no
if [ $# -eq 0 ]; then
    heavy=yes
    set -- scenes/paper/comparison_900m.ron scenes/paper/multi_tether_yaw.ron scenes/paper/towing_9700m.ron \
        scenes/paper/flight_chain.ron scenes/mav_dock.ron scenes/paper/sail_trajectory.ron \
        scenes/examples/reel_and_release.ron
fi

mkdir -p "$folder/runs" "$folder/pages" "$folder/pictures"
for scene in "$@"; do
    name=$(basename "$scene" .ron)
    "$aerobot" run "$scene" --out "$folder/runs/$name" --set run.record.channels=All --report --force --quiet
    cp "$folder/runs/$name/report.html" "$folder/pages/$name.html"
    "$aerobot" export "$folder/runs/$name" --gltf "$folder/pages/$name.glb" --frames 300 --force --quiet
done
if [ $heavy = yes ]; then
    # Sixty seconds of 200 nodes, 1500 frames: is it smooth, and how long is the file?
    "$aerobot" run scenes/paper/comparison_900m.ron --out "$folder/runs/two_hundred_nodes" --until 60 --report --force \
        --quiet --set entities.tether.Tether.nodes=200 --set run.output_every_s=0.04 --set 'run.integrator=Auto()'
    cp "$folder/runs/two_hundred_nodes/report.html" "$folder/pages/two_hundred_nodes.html"
    ls -l "$folder/pages/two_hundred_nodes.html"
    # Pages without a view: the paper's cases, a campaign, a design search.
    rm -rf "$folder/runs/campaign" "$folder/runs/search"
    "$aerobot" reproduce --out "$folder/runs/reproduce" --force --quiet
    "$aerobot" campaign run scenes/campaigns/gusts_1000.ron --out "$folder/runs/campaign" --quiet
    "$aerobot" optimise scenes/campaigns/lightest_tether.ron --out "$folder/runs/search" --quiet
    "$aerobot" report "$folder/runs/campaign" --quiet
    "$aerobot" report "$folder/runs/search" --quiet
    for name in reproduce campaign search; do
        cp "$folder/runs/$name/report.html" "$folder/pages/$name.html"
    done
fi
cargo run --quiet -p aerobot-report --example yawed_page "$folder/known.html"

cd tests/browser
[ -d node_modules ] || npm ci
REPORTS="$folder/pages" KNOWN="$folder/known.html" node --test
node validate_gltf.mjs "$folder/pages"
node screenshots.js "$folder/pages" "$folder/pictures"
