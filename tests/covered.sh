#!/bin/sh
# Whether every test that scenes/extreme/covered.txt names is there: covered.sh SOURCE_FOLDER
set -eu
cd "$1"
bad=0
while IFS='|' read -r number title file function; do
    case $number in '#'* | '') continue ;; esac
    file=$(echo $file) function=$(echo $function)
    grep -q "cmocka_unit_test($function)" "tests/$file.c" && continue
    echo "case $number,$title: tests/$file.c has no test $function"
    bad=1
done <scenes/extreme/covered.txt
exit $bad
