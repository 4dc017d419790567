#!/bin/sh
# demo.sh BRIO FOLDER: a simulated scan of a sculpture of genus 3, its surface, and how far that is from the truth.
set -eu

brio=$1
out=$2
points=60000

mkdir -p "$out"
echo "== a scan of about $points points from 12 views, and the surface that is scanned"
"$brio" generate scan -n $points --truth "$out/truth.ply" -o "$out/scan.ply"
echo
echo "== the surface through the points, with its certificate"
"$brio" surface "$out/scan.ply" -o "$out/demo.ply" --picture "$out/demo.png"
echo
echo "== the surface held against the truth"
"$brio" compare "$out/demo.ply" "$out/truth.ply"
echo
echo "== a page that shows the scan and its surface in a browser"
"$brio" view "$out/scan.ply" "$out/demo.ply" --side-by-side --title "A scan and its surface" -o "$out/demo.html"
echo
echo "Written: $out/scan.ply, $out/demo.ply, $out/truth.ply, $out/demo.png; open $out/demo.html in a browser"
