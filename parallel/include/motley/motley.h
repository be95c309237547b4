// Everything that a host includes.
#pragma once

#include "motley/core/assembly.h"
#include "motley/core/contact_events.h"
#include "motley/core/crowd_index.h"
#include "motley/core/memory.h"
#include "motley/core/polygon.h"
#include "motley/core/scene.h"
#include "motley/core/settings.h"
#include "motley/core/six_dof.h"
#include "motley/core/snapshot.h"
#include "motley/core/step_report.h"
#include "motley/core/wall_index.h"
#include "motley/core/wheel.h"
#include "motley/parallel/executor.h"
#include "motley/parallel/parallel_for.h"
#include "motley/parallel/solver.h"
#include "motley/soa/isa.h"
