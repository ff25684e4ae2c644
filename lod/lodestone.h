// All of the engine in one include, installed as <lodestone/lodestone.h>. <lodestone/lod/manager.h> and the
// others serve alone, too.
#pragma once

// IWYU pragma: begin_exports
#include "lod/body.h"
#include "lod/events.h"
#include "lod/ground_id.h"
#include "lod/groups.h"
#include "lod/hooks.h"
#include "lod/jobs.h"
#include "lod/manager.h"
#include "lod/policy.h"
#include "lod/queries.h"
#include "lod/record.h"
#include "lod/signatures.h"
#include "lod/step_report.h"
#include "lod/tables_options.h"
#include "lod/version.h"
#include "lod/viewpoint.h"
#include "lod/why.h"
#include "reference/error.h"
#include "reference/geometry.h"
#include "reference/material.h"
#include "reference/mesh/mesh.h"
#include "reference/shape.h"
#include "reference/simulation_error.h"
#include "signature/signature_file.h"
#include "signature/signature_source.h"
// IWYU pragma: end_exports
