// All effects: constraints, supports, loads and contact. Each function makes an effect for World::add; bad
// parameters are reported there.
#pragma once

#include "isochor/effects/active.h"
#include "isochor/effects/cable.h"
#include "isochor/effects/cavity.h"
#include "isochor/effects/contact.h"
#include "isochor/effects/idle.h"
#include "isochor/effects/layer.h"
#include "isochor/effects/load.h"
#include "isochor/effects/support.h"
#include "isochor/effects/volume.h"
#include "isochor/world.h"
