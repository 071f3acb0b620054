# Run time against true error, one cycle and the plane: gnuplot -c plot_work_precision.gp STEM
# reads STEM.cycle.dat and STEM.plane.dat, writes STEM.svg and STEM.png.
stem = ARG1
names = "rosin|rosin, transient only|CVODE|CVODE, good variables|odeint rosenbrock4|odeint, good variables|SciPy Radau|SciPy LSODA"
name(i) = substr(names, start(i), stop(i))
start(i) = i == 1 ? 1 : stop(i - 1) + 2
stop(i) = start(i) - 2 + strstrt(substr(names, start(i), strlen(names)) . "|", "|")
# Okabe & Ito's colours; pairs share a colour, and each has a mark and a dash of its own.
set linetype 1 lc rgb "#000000" dt 1 lw 3.0 pt 7 ps 0.9
set linetype 2 lc rgb "#000000" dt 2 lw 1.6 pt 6 ps 0.9
set linetype 3 lc rgb "#0072B2" dt 1 lw 1.6 pt 5 ps 0.8
set linetype 4 lc rgb "#0072B2" dt 2 lw 1.6 pt 4 ps 0.8
set linetype 5 lc rgb "#D55E00" dt 1 lw 1.6 pt 9 ps 1.0
set linetype 6 lc rgb "#D55E00" dt 2 lw 1.6 pt 8 ps 1.0
set linetype 7 lc rgb "#009E73" dt 1 lw 1.6 pt 13 ps 1.0
set linetype 8 lc rgb "#CC79A7" dt 3 lw 1.8 pt 2 ps 0.8

do for [format in "svg png"] {
  if (format eq "svg") {
    set terminal svg size 900,470 font "Helvetica,13" background rgb "white"
  } else {
    set terminal pngcairo size 1800,940 font "Helvetica,13" fontscale 1.5 pointscale 2 linewidth 2
  }
  set output sprintf("%s.%s", stem, format)
  set multiplot
  set logscale xy
  set format y "10^{%T}"
  set xrange [1:1e-14]  # better to the right
  set xtics ("1" 1)
  set for [e = 1:7] xtics add (sprintf("10^{%d}", -2 * e) 10**(-2 * e))
  set mytics 2
  set grid lc rgb "#dddddd" lw 0.6 dt 1
  set border 3
  set tics nomirror out
  set tmargin at screen 0.92
  set bmargin at screen 0.31
  unset key

  set lmargin at screen 0.085
  set rmargin at screen 0.48
  set yrange [1e-4:1e2]
  set title "One cycle: N = 10^{−4} m g, λ = 10" offset 0, -0.5
  set xlabel "largest true error of period, stick fraction, loop area" offset 0, 0.4
  set ylabel "processor time, s" offset 0.5, 0
  plot for [i = 1:8] stem . ".cycle.dat" index (name(i) . ";") using 1:2 with linespoints lt i

  set lmargin at screen 0.56
  set rmargin at screen 0.97
  set title "Plane: N/(m g) = 10^{−8} … 1, λ = 10^{−4} … 10^2"
  set xlabel "the same, met by nine cycles in ten" offset 0, 0.4
  set ylabel "processor time per cycle, s"
  plot for [i = 1:8] stem . ".plane.dat" index (name(i) . ";") using 1:2 with linespoints lt i

  # One key for both panels, below them.
  unset title; unset xlabel; unset ylabel; unset border; unset tics; unset grid
  unset logscale
  set xrange [0:1]; set yrange [0:1]
  set lmargin at screen 0.02; set rmargin at screen 0.98
  set tmargin at screen 0.155; set bmargin at screen 0.01
  set key inside center center vertical maxrows 2 Left reverse width -2 samplen 3 spacing 1.4 font ",12"
  plot for [i = 1:8] NaN with linespoints lt i title name(i)
  unset multiplot
  unset output
  reset
}
