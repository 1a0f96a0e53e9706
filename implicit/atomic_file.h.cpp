#include "../../../work/main/implicit/atomic_file.h"
#include "../../../work/main/implicit/atomic_file.h"
