#!/bin/sh
# Launcher of a precompiled header's compiler: removes the old one first. GCC would read it into the new one, whose bytes then belong to this
# build folder alone, and the compiler cache could serve nothing that uses it.
#   fresh_header.sh OLD COMPILER ARGUMENTS...
old=$1
shift
case " $* " in *" -x c++-header "*) rm -f "$old" ;; esac
exec "$@"
