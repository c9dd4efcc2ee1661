#!/bin/sh
# usage: manual.sh FOLDER COMPLETION_HEADER [EMULATOR WORD...] -- INSTALLED_NAME=PROGRAM...
# Every program writes pages about itself; they become FOLDER/man1/*.1.gz and FOLDER/completions/, one file for all
# programs, with a link per program, since bash looks for the completion of a program under the program's name.
set -eu
folder=$1 header=$2
shift 2
emulator=
while [ "$1" != -- ]; do emulator="$emulator $1"; shift; done
shift
rm -rf "$folder"
mkdir -p "$folder/man1" "$folder/completions"
names=
for each in "$@"; do
  name=${each%%=*}
  $emulator "${each#*=}" --pages "$folder/man1" "$name"
  names="$names $name"
done
{
  cat "$header" "$folder"/man1/*.completion
  echo "complete -F _fathom$names"
} >"$folder/completions/fathom"
rm "$folder"/man1/*.completion
for name in $names; do
  [ "$name" = fathom ] || ln -s fathom "$folder/completions/$name"
done
gzip -9n "$folder"/man1/*.1
