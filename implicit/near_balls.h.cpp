#include "../../../work/main/implicit/near_balls.h"
#include "../../../work/main/implicit/near_balls.h"
