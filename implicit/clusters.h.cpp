#include "../../../work/main/implicit/clusters.h"
#include "../../../work/main/implicit/clusters.h"
