// httplib, whose resolv.h defines a macro _res: Eigen's headers use the name for their own arguments.
#pragma once

#include <httplib.h>

#undef _res
