#include "server/import/gltf_file.h"
