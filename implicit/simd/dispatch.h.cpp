#include "../../../work/main/implicit/simd/dispatch.h"
#include "../../../work/main/implicit/simd/dispatch.h"
