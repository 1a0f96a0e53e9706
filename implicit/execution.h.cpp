#include "../../../work/main/implicit/execution.h"
#include "../../../work/main/implicit/execution.h"
