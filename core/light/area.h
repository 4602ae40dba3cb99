#pragma once

#include "core/light/disk_light.h"
#include "core/light/rect_light.h"
#include "core/light/sphere_light.h"
#include "core/light/triangle.h"
