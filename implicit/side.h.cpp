#include "../../../work/main/implicit/side.h"
#include "../../../work/main/implicit/side.h"
