#include "../../../work/main/implicit/primitive.h"
#include "../../../work/main/implicit/primitive.h"
