#!/bin/sh
# Builds the site; a warning of Sphinx or Doxygen is an error: build.sh SOURCE FOLDER ROSIN, called by the target `site`, which says in
# the environment where the rest is.
set -eu
source=$1 site=$2 rosin=$3
mkdir -p "$site/source/_static"
/usr/bin/python3 "$source/docs/site/prepare.py" "$source" "$site/source" "$rosin"
cd "$source"
doxygen "$site/Doxyfile"
# Of MathJax only what draws TeX as SVG: 3 MB.
mathjax=$site/source/_static/mathjax
if [ ! -d "$mathjax" ]; then
  mkdir -p "$mathjax/jax/output/SVG/fonts" "$mathjax/config"
  cd "$ROSIN_MATHJAX"
  cp -rL extensions "$mathjax"
  cp -rL jax/input jax/element "$mathjax/jax"
  cp -rL jax/output/SVG/*.js jax/output/SVG/autoload "$mathjax/jax/output/SVG"
  cp -rL jax/output/SVG/fonts/TeX "$mathjax/jax/output/SVG/fonts"
  cp -L config/TeX-AMS_SVG.js "$mathjax/config"
  cp -L MathJax.js "$mathjax"
fi
cd "$site"
if ! sphinx-build -W --keep-going -q -j auto -d doctrees source html; then
  rm -r doctrees # or the next run would read changed pages only, and not warn of the others again
  exit 1
fi
echo "the site: file://$site/html/index.html"
