#include "../../../work/main/implicit/errors.h"
#include "../../../work/main/implicit/errors.h"
