#!/bin/sh
# Makes DejaVuSans-subset.ttf from the DejaVuSans.ttf of DejaVu 2.37 (Debian: fonts-dejavu-core 2.37) with fontTools 4.68.
# Usage: fonts/subset.sh /usr/share/fonts/truetype/dejavu/DejaVuSans.ttf
set -eu
pyftsubset "$1" \
  --unicodes="U+0020-007E,U+00A0-017F,U+01A0,U+01A1,U+01AF,U+01B0,U+02B0-02FF,U+0300-0303,U+0307,U+0308,U+0370-03FF,\
U+0400-045F,U+0490,U+0491,U+1D43-1D6A,U+1D9C-1DBF,U+1E80-1EF9,U+2010-2027,U+2030-203A,U+2044,U+205F,U+2070-209C,U+20AC,\
U+2102-2126,U+2150-215E,U+2190-2195,U+21D0-21D5,U+2200-22A5,U+22C5,U+2308-230B,U+25A0-25CF,U+27E8,U+27E9,U+FFFD" \
  --no-hinting --layout-features='' --drop-tables+=GPOS,GSUB,GDEF,kern,FFTM,DSIG --name-IDs='0,1,2,3,4,5,6,13,14' \
  --notdef-outline --no-recalc-timestamp --output-file="$(dirname "$0")/DejaVuSans-subset.ttf"
