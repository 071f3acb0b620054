#!/bin/sh
# Largest Lyapunov exponent of a block on a belt over the width by which its friction is smoothed: chaos-by-smoothing.sh ROSIN FOLDER
set -eu
rosin=$1 folder=$2
# The exponent and its standard error; the latter is nan of a periodic motion, whose multipliers give the exponent.
exponent() {
  "$rosin" lyapunov examples/belt-chaos.toml --set drive.speed=0.1 "$@" --out "$folder/lyapunov" --no-pictures |
    awk '/^periodic/ { periodic = 1 } $1 " " $2 == "exponent 1" { print $3 "," (periodic ? "nan" : $5) }'
}
{
  echo 'width (m/s),exponent (1/s),standard error (1/s)'
  echo "0,$(exponent)"
  for width in $(awk 'BEGIN { for (i = 0; i <= 48; ++i) printf "%.4g ", 10 ^ (-5 + i / 12) }'); do
    echo "$width,$(exponent --set "solver.smoothing={ type = 'tanh', width = $width }")"
  done
} >"$folder/chaos-by-smoothing.csv"
cat >"$folder/chaos-by-smoothing.gp" <<'GNUPLOT'
set terminal svg size 760,430 font 'sans-serif,13' background 'white'
set output 'chaos-by-smoothing.svg'
set datafile separator ','
set datafile missing 'nan'
set encoding utf8
set logscale x
set format x '10^{%L}'
set xrange [8e-6:0.13]
set yrange [-0.72:0.22]
set grid linecolor '#CCCCCC' linewidth 0.6
set xzeroaxis linetype 1 linecolor '#555555'
set xlabel 'width of smoothing ε (m/s)'
set ylabel 'largest exponent λ_1 (1/s)'
set key at graph 0.6,0.22
data = 'chaos-by-smoothing.csv'
stats data every ::1::1 using 2 nooutput
plot STATS_min with lines linewidth 1.8 dashtype (8,4) linecolor '#B0560F' title 'stick kept', \
     data every ::2 using 1:($3 == $3 ? NaN : $2) with points pointtype 7 pointsize 0.5 linecolor '#00336F' title 'tanh: periodic', \
     data every ::2 using 1:2:3 with yerrorbars pointtype 6 pointsize 0.6 linecolor '#8A4FA3' title 'tanh: chaotic, with standard error'
GNUPLOT
cd "$folder"
gnuplot chaos-by-smoothing.gp
