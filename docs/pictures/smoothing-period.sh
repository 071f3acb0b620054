#!/bin/sh
# How much too short smoothing makes the period of a block on a belt, over the width of smoothing: smoothing-period.sh ROSIN FOLDER
set -eu
rosin=$1 folder=$2
scene=examples/leine-belt-block.toml
period() {
  "$rosin" cycle $scene "$@" --out "$folder/cycle" --quiet --no-pictures --json | sed -n 's/^ *"period": \([0-9.e-]*\),*$/\1/p' | head -n 1
}
exact=$(period)
{
  echo 'width (m/s),arctan (s),tanh (s),parabolic (s),linear (s),exact (s)'
  for width in 1e-5 1e-4 1e-3 1e-2 1e-1; do
    printf %s $width
    for type in arctan tanh parabolic linear; do
      period --set "solver.smoothing={ type = '$type', width = $width }" | awk -v exact="$exact" '{ printf ",%.6g", exact - $1 }'
    done
    echo ",$exact"
  done
} >"$folder/smoothing-period.csv"
cat >"$folder/smoothing-period.gp" <<'GNUPLOT'
set terminal svg size 560,400 font 'sans-serif,13' background 'white'
set output 'smoothing-period.svg'
set datafile separator ','
set encoding utf8
set logscale xy
set format '10^{%L}'
set xrange [5e-6:0.2]
set yrange [1e-4:30]
set grid linecolor '#CCCCCC' linewidth 0.6
set xlabel 'width of smoothing (m/s)'
set ylabel 'period too short by (s)'
set key bottom right
colours = '#B0560F #00336F #3A8F5C #8A4FA3'
plot for [i=2:5] 'smoothing-period.csv' using 1:i with linespoints linewidth 1.5 linecolor rgb word(colours, i - 1) \
       pointtype 2*i + 1 pointsize 0.8 \
       title columnheader(i)[1:strlen(columnheader(i)) - 4], \
     'smoothing-period.csv' using 1:6 with lines dashtype 3 linecolor '#555555' title 'the exact period'
GNUPLOT
cd "$folder"
gnuplot smoothing-period.gp
