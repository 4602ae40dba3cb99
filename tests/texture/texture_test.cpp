#include "core/texture/texture.h"

#include <gtest/gtest.h>
