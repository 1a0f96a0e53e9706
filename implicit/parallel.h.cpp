#include "../../../work/main/implicit/parallel.h"
#include "../../../work/main/implicit/parallel.h"
