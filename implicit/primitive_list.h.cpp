#include "../../../work/main/implicit/primitive_list.h"
#include "../../../work/main/implicit/primitive_list.h"
