# lcm-gen's decoders believe every length: a damaged message could ask for 16 GB or a negative string.
# This bounds each length by the bytes that are left (an element takes at least one), before anything is allocated.
# Reals are read and written by fathom_reals.hpp, which says why.
# Use: cmake -DHEADER=x_t.hpp -P guard_lengths.cmake
file(READ ${HEADER} text)
string(REGEX REPLACE "(\n *)(this->[a-z_A-Z0-9]+)\\.resize\\((this->[a-z_A-Z0-9]+)\\);"
       "\\1if(\\3 < 0 || \\3 > maxlen - pos) return -1;\\1\\2.resize(static_cast<std::size_t>(\\3));" text "${text}")
string(REGEX REPLACE "if\\((__[a-z_A-Z0-9]+) > maxlen - pos\\) return -1;"
       "if(\\1 < 1 || \\1 > maxlen - pos) return -1;" text "${text}")
foreach(way encode decode)
  string(REPLACE "__double_${way}_array(" "fathom_reals::${way}_doubles(" text "${text}")
  string(REPLACE "__float_${way}_array(" "fathom_reals::${way}_floats(" text "${text}")
endforeach()
string(REPLACE "#include <lcm/lcm_coretypes.h>" "#include <lcm/lcm_coretypes.h>\n#include \"fathom_reals.hpp\"" text "${text}")
file(WRITE ${HEADER} "${text}")
