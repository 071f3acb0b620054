#!/bin/sh
# Velocity of a block on a belt where it sticks, with stick kept and with friction smoothed: belt-stick-branch.sh ROSIN FOLDER
set -eu
rosin=$1 folder=$2
# One period: displacement (m) and velocity (m/s), of a belt of 0.2 m/s.
orbit() {
  name=$1
  shift
  "$rosin" cycle examples/leine-belt-block.toml "$@" --out "$folder/$name" --no-pictures --quiet
  { echo 'displacement (m),velocity (m/s)' && awk -F, 'NR > 1 { print $2 "," $3 }' "$folder/$name/cycle.csv"; } >"$folder/belt-stick-branch-$name.csv"
}
smoothed() {
  orbit "$1" --set "solver.smoothing={ type = '$2', width = $3 }"
}
orbit exact
smoothed tanh tanh 1e-3
smoothed tanh-narrow tanh 1e-4
smoothed arctan arctan 1e-4
cat >"$folder/belt-stick-branch.gp" <<'GNUPLOT'
set terminal svg size 940,430 font 'sans-serif,13' background 'white'
set output 'belt-stick-branch.svg'
set datafile separator ','
set encoding utf8
set grid linecolor '#CCCCCC' linewidth 0.6
set xrange [-0.8:1.2]
set xlabel 'displacement (m)'
set format y '%.4f'
set multiplot layout 1,2 margins 0.12,0.98,0.14,0.96 spacing 0.11,0
set key inside top right
set ylabel 'velocity (m/s)'
set yrange [0.197:0.203]
plot 'belt-stick-branch-exact.csv' every ::1 with lines linewidth 2 linecolor '#222222' title 'stick kept', \
     'belt-stick-branch-tanh.csv' every ::1 with lines linewidth 1.5 linecolor '#B0560F' title 'tanh, 10^{-3} m/s', \
     'belt-stick-branch-tanh-narrow.csv' every ::1 with lines linewidth 1.5 dashtype (8,3) linecolor '#B0560F' title 'tanh, 10^{-4} m/s', \
     'belt-stick-branch-arctan.csv' every ::1 with lines linewidth 1.5 dashtype (3,3) linecolor '#00336F' title 'arctan, 10^{-4} m/s'
unset ylabel
unset key
set yrange [0.1992:0.2004]
plot 'belt-stick-branch-exact.csv' every ::1 with lines linewidth 2 linecolor '#222222', \
     'belt-stick-branch-tanh.csv' every ::1 with lines linewidth 1.5 linecolor '#B0560F', \
     'belt-stick-branch-tanh-narrow.csv' every ::1 with lines linewidth 1.5 dashtype (8,3) linecolor '#B0560F', \
     'belt-stick-branch-arctan.csv' every ::1 with lines linewidth 1.5 dashtype (3,3) linecolor '#00336F'
unset multiplot
GNUPLOT
cd "$folder"
gnuplot belt-stick-branch.gp
