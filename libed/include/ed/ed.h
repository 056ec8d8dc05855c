#pragma once

/// @file
/// Includes the whole public interface of libed, except for serialisation (archive*.h, arithmetic.h, sink.h).

/// @namespace ed libed: event-driven dynamics of hard bodies.

#include <ed/analysis.h>
#include <ed/contact_options.h>
#include <ed/equilibration.h>
#include <ed/given/contact.h>
#include <ed/given/motion.h>
#include <ed/given/scene.h>
#include <ed/impulse.h>
#include <ed/motion.h>
#include <ed/observables.h>
#include <ed/polydispersity.h>
#include <ed/random.h>
#include <ed/replicas.h>
#include <ed/shape.h>
#include <ed/simulation.h>
#include <ed/snapshot.h>
#include <ed/start.h>
#include <ed/stored_frames.h>
#include <ed/system.h>
#include <ed/time_of_contact.h>
#include <ed/tolerances.h>
