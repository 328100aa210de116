// Contact and rigid bodies, by the name that hosts know.
#pragma once

#include "isochor/effects/contact.h"
#include "isochor/world.h"
