#include "server/import/gltf_look.h"
