/* The engine from C11: a heap of crates on all rungs with events, queries, lists, bulk reading, a snapshot, a recording and hooks; every failure is a result with its reason. */
#include <lodestone/lodestone_c.h>

#include <math.h>
#include <ode/ode.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BODIES 60

static int failures = 0;

static void that(bool holds, const char* what) {
  printf("%s %s\n", holds ? "ok  " : "FAIL", what);
  failures += !holds;
}

static void within(double value, double least, double most, const char* what) {
  const bool holds = value >= least && value <= most;
  printf("%s %s: %.6g, of %.6g to %.6g\n", holds ? "ok  " : "FAIL", what, value, least, most);
  failures += !holds;
}

static void done(lodestone_result result, const char* what) {
  if (result != LODESTONE_OK) printf("FAIL %s: %s\n", what, lodestone_error());
  failures += result != LODESTONE_OK;
}
#define DO(call) done(call, #call)

static void refused(lodestone_result result, const char* because, const char* what) {
  const bool holds = result == LODESTONE_BAD_INPUT && strstr(lodestone_error(), because);
  printf("%s refused: %s\n", holds ? "ok  " : "FAIL", what);
  if (!holds) printf("     it said: %s\n", lodestone_error());
  failures += !holds;
}

/* ---- What the library calls ---- */

static void count_ground(void* context, size_t ray, const lodestone_hit* hit) {
  (void)ray;
  *(int*)context += hit->who.kind == LODESTONE_SIDE_GROUND;
}

static int jobs_run = 0;
static void run_jobs(void* context, int64_t count, lodestone_task task, const void* task_context) {
  ++*(int*)context;
  for (int64_t i = count; i-- > 0;) task(task_context, i);
}

static bool never_meet_the_ghost(void* context, lodestone_body first, lodestone_body second) {
  const lodestone_body* ghost = context;
  return first.index != ghost->index && second.index != ghost->index;
}

static int zones_open = 0, zones = 0;
static void begin_zone(void* context, const char* zone) { (void)context, (void)zone, ++zones_open, ++zones; }
static void end_zone(void* context, const char* zone) { (void)context, (void)zone, --zones_open; }
static void count_line(void* context, lodestone_vec3 from, lodestone_vec3 to, lodestone_color color) { (void)from, (void)to, (void)color, ++*(int*)context; }
static void note_log(void* context, lodestone_log_level level, const char* text) {
  if (level == LODESTONE_LOG_INFO && strstr(text, "signature")) ++*(int*)context;
}

struct recording { unsigned char* bytes; size_t size; };
static void append(void* context, const void* bytes, size_t size) {
  struct recording* to = context;
  to->bytes = realloc(to->bytes, to->size + size);
  memcpy(to->bytes + to->size, bytes, size);
  to->size += size;
}

static void count_found(void* context, size_t volume, const lodestone_hit* hit) {
  if (hit->who.kind == LODESTONE_SIDE_BODY) ++((int*)context)[volume];
}

static int signatures_asked = 0;
static const lodestone_signature* lend_signature(void* context, const char* shape_name, double restitution, double friction) {
  signatures_asked += !strcmp(shape_name, "crate") && restitution >= 0 && friction >= 0;
  return context;
}

/* ---- A world of the manager's own ---- */

static lodestone_manager* make_manager(int* jobs, lodestone_body* ghost) {
  lodestone_settings settings = lodestone_default_settings();
  settings.seed = 5;
  settings.signature_timing = LODESTONE_SIGNATURES_IN_STEP;
  settings.policy.full_within = 1.5;
  settings.policy.support_within = 3.0;
  settings.policy.max_transitions_per_frame = 10;
  settings.events.all_bodies = true;
  settings.jobs = run_jobs;
  settings.jobs_context = jobs;
  settings.pair_filter = never_meet_the_ghost;
  settings.pair_filter_context = ghost;
  lodestone_manager* manager = NULL;
  DO(lodestone_create(&settings, &manager));
  const lodestone_vec3 up = {0, 0, 1};
  DO(lodestone_add_plane(manager, up, 0.0, 0, NULL));
  return manager;
}

static void look_from(lodestone_manager* manager, double x) {
  const lodestone_viewpoint camera = lodestone_default_viewpoint((lodestone_vec3){x, 0, 0.5});
  DO(lodestone_set_viewpoints(manager, &camera, 1));
}

static void check_a_heap(void) {
  lodestone_shape* crate = NULL;
  const lodestone_vec3 sides = {0.2, 0.3, 0.4};
  DO(lodestone_make_box("crate", sides, &crate));
  lodestone_body ghost = {~0u, 0}, bodies[BODIES];
  lodestone_manager* manager = make_manager(&jobs_run, &ghost);
  int32_t rubber = 0;
  DO(lodestone_add_material(manager, 0.6, 0.8, 500.0, &rubber));
  within(rubber, 1, 1, "a material's number");

  for (int i = 0; i < BODIES; ++i) {
    lodestone_body_definition definition = lodestone_default_body(crate);
    definition.state.position = (lodestone_vec3){0.3 * (i % 20), 0.0, 0.5 + 0.5 * (i / 20)};
    definition.material = i % 2 ? rubber : 0;
    definition.user_data = (uintptr_t)(1000 + i);
    DO(lodestone_add_body(manager, &definition, &bodies[i]));
  }
  size_t count = 0;
  DO(lodestone_body_count(manager, &count));
  within((double)count, BODIES, BODIES, "bodies");
  int signatures = 0;
  DO(lodestone_set_log(manager, note_log, &signatures));
  look_from(manager, 0.0);
  lodestone_report report;
  int events[3] = {0, 0, 0}, rung_changes = 0;
  for (int i = 0; i < 90; ++i) {
    if (i == 45) look_from(manager, 6.0);
    DO(lodestone_step(manager, 1.0 / 60.0, &report));
    const lodestone_contact_event* list = NULL;
    DO(lodestone_contact_events(manager, &list, &count));
    for (size_t e = 0; e < count; ++e) ++events[list[e].phase];
    const lodestone_rung_change* changes = NULL;
    DO(lodestone_rung_changes(manager, &changes, &count));
    rung_changes += (int)count;
  }
  DO(lodestone_set_log(manager, NULL, NULL));
  within(signatures, 1, 4, "signatures that the log told of");
  within(jobs_run, 1, 1e9, "times that the caller's jobs were run");
  within((double)report.step, 90, 90, "steps");
  that(report.full > 0 && report.support > 0 && report.tables > 0 && report.full + report.support + report.tables == BODIES, "bodies on all three rungs");
  within(events[LODESTONE_CONTACT_BEGIN], BODIES, 1e9, "contacts that began");
  within(events[LODESTONE_CONTACT_HIT], BODIES, 1e9, "hits");
  within(rung_changes, 2, 1e9, "changes of rung");

  /* One by one and all at once. */
  lodestone_state states[BODIES], state;
  float positions[3 * BODIES], orientations[4 * BODIES];
  DO(lodestone_read_states(manager, bodies, BODIES, states));
  DO(lodestone_read_poses(manager, bodies, BODIES, positions, orientations));
  DO(lodestone_get_state(manager, bodies[7], &state));
  that(!memcmp(&state, &states[7], sizeof state), "a state among many is the state");
  that(positions[3 * 7] == (float)state.position.x && orientations[4 * 7] == (float)state.orientation.w, "so is a pose");
  uintptr_t data = 0;
  double mass = 0;
  lodestone_rung rung = LODESTONE_TABLES;
  struct dxBody* ode_body = NULL;
  char why[8];
  size_t length = 0;
  DO(lodestone_get_user_data(manager, bodies[7], &data));
  DO(lodestone_get_mass(manager, bodies[7], &mass));
  within((double)data, 1007, 1007, "user data");
  within(mass, 12 - 1e-9, 12 + 1e-9, "mass of a crate of rubber, kg");
  int with_ode = 0, full = 0;
  for (int i = 0; i < BODIES; ++i) {
    DO(lodestone_get_rung(manager, bodies[i], &rung));
    DO(lodestone_get_ode_body(manager, bodies[i], &ode_body));
    full += rung == LODESTONE_FULL;
    with_ode += ode_body != NULL;
  }
  that(full == report.full && with_ode == full, "full bodies have a dBodyID");
  DO(lodestone_why(manager, bodies[7], why, sizeof why, &length));
  that(report.times.total_ms > 0 && report.counters.ode_bodies_created >= report.full && report.counters.signatures_loaded >= 1, "times and counters of the last step");
  that(length > sizeof why && strlen(why) == sizeof why - 1, "a text that is cut has its zero");

  lodestone_reason reason;
  DO(lodestone_explain(manager, bodies[7], &reason));
  DO(lodestone_get_rung(manager, bodies[7], &rung));
  that(reason.placed && reason.rung == rung && reason.group.generation == 0, "why a body has its rung, as a structure");
  that(reason.rule == LODESTONE_RULE_FAR || reason.rule == LODESTONE_RULE_WITHIN_HYSTERESIS, "far from the viewpoint, it says");
  within(reason.distance_m, 3.0, 5.0, "its distance from the viewpoint, m");
  lodestone_group group;
  DO(lodestone_make_group(manager, bodies, 3, NULL, NULL, NULL, &group));
  DO(lodestone_explain(manager, bodies[1], &reason));
  that(reason.group.index == group.index && reason.group.generation == group.generation, "a body in a group says so");
  refused(lodestone_make_group(manager, bodies, 1, NULL, NULL, NULL, NULL), "group", "a body in two groups");
  DO(lodestone_dissolve_group(manager, group));
  refused(lodestone_set_rung_range(manager, bodies[1], LODESTONE_FULL, LODESTONE_TABLES), "", "a least rung above the greatest");

  /* Queries. */
  const lodestone_vec3 above = {state.position.x, state.position.y, 5.0}, down = {0, 0, -1};
  const lodestone_ray rays[3] = {{above, down, 10.0, 0.0}, {above, down, 10.0, 0.05}, {{50, 50, 5}, down, 1.0, 0.0}};
  bool met[3];
  lodestone_hit hits[3];
  DO(lodestone_cast_rays(manager, rays, 3, NULL, met, hits));
  that(met[0] && met[1] && !met[2] && hits[0].who.kind == LODESTONE_SIDE_BODY, "rays and spheres from above meet a body, one elsewhere nothing");
  within(hits[0].distance - hits[1].distance, 0.0, 0.2, "the sphere meets it first, by, m");
  int through[3] = {0, 0, 0}, ground_through = 0;
  DO(lodestone_cast_rays_through(manager, rays, 3, NULL, count_found, through));
  that(through[0] >= 1 && through[1] >= through[0] && through[2] == 0, "rays and spheres through all that they meet");
  DO(lodestone_cast_rays_through(manager, rays, 1, NULL, count_ground, &ground_through));
  within(ground_through, 1, 1, "the plane under it, too");
  refused(lodestone_cast_rays_through(manager, rays, 1, NULL, NULL, NULL), "found", "nobody to tell");
  lodestone_volume volumes[2] = {{.radius = 0.01, .position = state.position}, {.sides = {100, 100, 100}, .orientation = {1, 0, 0, 0}}};
  int found[2] = {0, 0};
  DO(lodestone_overlap(manager, volumes, 2, NULL, count_found, found));
  that(found[0] >= 1 && found[1] == BODIES, "a small sphere finds its body, a large box all");

  /* What is done to bodies. */
  const lodestone_vec3 none = {0, 0, 0}, lift = {0, 0, 600};
  DO(lodestone_add_impulse(manager, bodies[0], (lodestone_vec3){0, 0, 48}, states[0].position));
  DO(lodestone_get_state(manager, bodies[0], &state));
  within(state.velocity.z - states[0].velocity.z, 2.0 - 1e-6, 2.0 + 1e-6, "what an impulse adds, m/s");
  DO(lodestone_add_force(manager, bodies[1], lift, none));
  DO(lodestone_sleep(manager, bodies[2]));
  bool asleep = false;
  DO(lodestone_is_asleep(manager, bodies[2], &asleep));
  that(asleep, "a body that was laid to sleep sleeps");
  DO(lodestone_wake(manager, bodies[2]));
  DO(lodestone_is_asleep(manager, bodies[2], &asleep));
  that(!asleep, "and wakes");
  lodestone_properties properties = lodestone_default_properties();
  properties.gravity = false;
  state.position = (lodestone_vec3){0, 9, 9};
  state.velocity = state.angular_velocity = none;
  DO(lodestone_set_properties(manager, bodies[3], &properties));
  DO(lodestone_set_state(manager, bodies[3], &state));
  DO(lodestone_step(manager, 1.0 / 60.0, NULL));
  DO(lodestone_get_state(manager, bodies[3], &state));
  within(state.position.z, 9.0 - 1e-9, 9.0 + 1e-9, "height of a body without gravity, m");
  const lodestone_body* moved = NULL;
  DO(lodestone_moved(manager, &moved, &count));
  bool is_among = false;
  for (size_t i = 0; i < count; ++i) is_among = is_among || moved[i].index == bodies[1].index;
  that(is_among, "who was pushed is among those that moved");

  /* Snapshot and recording. */
  size_t size = 0;
  DO(lodestone_snapshot(manager, NULL, 0, &size));
  void* kept = malloc(size);
  refused(lodestone_snapshot(manager, kept, size - 1, NULL), "capacity", "a buffer too small for a snapshot");
  DO(lodestone_snapshot(manager, kept, size, &size));
  struct recording recording = {NULL, 0};
  DO(lodestone_set_record(manager, append, &recording));
  uint64_t after = 0, again = 0;
  for (int i = 0; i < 30; ++i) DO(lodestone_step(manager, 1.0 / 60.0, NULL));
  DO(lodestone_set_record(manager, NULL, NULL));
  DO(lodestone_state_hash(manager, &after));
  lodestone_manager* other = make_manager(&jobs_run, &ghost);
  DO(lodestone_add_material(other, 0.6, 0.8, 500.0, NULL));
  const lodestone_shape* shapes[1] = {crate};
  DO(lodestone_restore(other, kept, size, shapes, 1));
  look_from(other, 6.0);
  for (int i = 0; i < 30; ++i) DO(lodestone_step(other, 1.0 / 60.0, NULL));
  DO(lodestone_state_hash(other, &again));
  that(after == again, "thirty steps from a snapshot give the same hash in another manager");
  lodestone_replay_result replayed = {0, false, {0, 0}, NULL};
  DO(lodestone_replay(other, recording.bytes, recording.size, shapes, 1, &replayed));
  that(replayed.same && replayed.steps == 30 && strstr(replayed.text, "30 steps"), "and so does a recording");
  ((unsigned char*)kept)[size / 2] ^= 1;
  refused(lodestone_restore(other, kept, size, shapes, 1), "checksum", "a damaged snapshot");
  free(kept);
  free(recording.bytes);
  lodestone_destroy(other);

  /* Hooks. */
  int lines = 0;
  lodestone_draw_settings drawing = lodestone_default_draw_settings();
  drawing.bounds = true;
  DO(lodestone_draw(manager, count_line, NULL, &lines, &drawing));
  within(lines, 18 * BODIES, 1e9, "lines drawn");
  drawing.bodies = drawing.contacts = drawing.bounds = false;
  const int drawn = lines;
  DO(lodestone_draw(manager, count_line, NULL, &lines, &drawing));
  within(lines - drawn, 0, 0, "lines where nothing is to be drawn");
  DO(lodestone_set_profile(manager, begin_zone, end_zone, NULL));
  DO(lodestone_step(manager, 1.0 / 60.0, NULL));
  DO(lodestone_set_profile(manager, NULL, NULL, NULL));
  that(zones >= 5 && zones_open == 0, "zones of the profiler begin and end");

  /* Ground that comes, moves and goes. */
  lodestone_ground box;
  lodestone_state lifted = {{0, 20, 1}, {1, 0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
  DO(lodestone_add_static_box(manager, (lodestone_vec3){1, 1, 0.2}, (lodestone_vec3){0, 20, 0.5}, (lodestone_quat){1, 0, 0, 0}, 0, &box));
  DO(lodestone_move_ground(manager, box, &lifted));
  const lodestone_ray onto_box = {{0, 20, 5}, down, 10.0, 0.0};
  DO(lodestone_cast_rays(manager, &onto_box, 1, NULL, met, hits));
  within(hits[0].distance, 3.9 - 1e-6, 3.9 + 1e-6, "way down to a box that was moved, m");
  that(met[0] && hits[0].who.kind == LODESTONE_SIDE_GROUND && hits[0].who.ground.index == box.index, "it is named");
  that(lodestone_is_valid_ground(manager, box), "ground that is there is valid");
  DO(lodestone_remove_ground(manager, box));
  that(!lodestone_is_valid_ground(manager, box), "removed, it is not");
  lodestone_vec3 gravity = none;
  DO(lodestone_get_gravity(manager, &gravity));
  within(gravity.z, -9.81, -9.81, "gravity, m/s2");
  refused(lodestone_remove_ground(manager, box), "", "ground that was removed");

  /* Failures. */
  uint64_t before = 0;
  DO(lodestone_state_hash(manager, &before));
  DO(lodestone_remove_body(manager, bodies[5]));
  that(!lodestone_is_valid(manager, bodies[5]) && lodestone_is_valid(manager, bodies[6]), "a removed body's id is not valid");
  DO(lodestone_state_hash(manager, &before));
  refused(lodestone_get_state(manager, bodies[5], &state), "", "a stale id");
  refused(lodestone_step(manager, NAN, NULL), "", "a step of NaN");
  refused(lodestone_step(NULL, 0.01, NULL), "manager", "no manager");
  refused(lodestone_set_state(manager, bodies[6], NULL), "state", "no state");
  refused(lodestone_set_level(manager, bodies[6], (lodestone_level_choice)9), "level", "a level that there is not");
  refused(lodestone_add_force(manager, bodies[6], (lodestone_vec3){INFINITY, 0, 0}, none), "force", "an infinite force");
  refused(lodestone_make_box("flat", (lodestone_vec3){1, 1, 0}, &crate), "", "a box without height");
  refused(lodestone_make_box("lost", (lodestone_vec3){1, 1, 1}, NULL), "handle", "a shape that goes nowhere");
  refused(lodestone_load_mesh("/nowhere.obj", 1.0, &crate), "/nowhere.obj", "a file that is not there");
  DO(lodestone_state_hash(manager, &again));
  that(before == again, "nothing has changed by any of them");
  lodestone_destroy(manager);
  lodestone_release_shape(crate);
}

/* ---- Signatures of the caller's, and the audit ---- */

static void check_signatures_and_audit(void) {
  lodestone_shape* crate = NULL;
  lodestone_signature *signature = NULL, *read = NULL;
  const lodestone_vec3 sides = {0.2, 0.3, 0.4};
  DO(lodestone_make_box("crate", sides, &crate));
  DO(lodestone_find_or_measure_signature(crate, 0.4, 0.5, 0, &signature));
  refused(lodestone_load_signature("/nowhere.sig", &read), "/nowhere.sig", "a signature's file that is not there");
  refused(lodestone_read_signature("none", 4, &read), "", "bytes that are no signature");
  lodestone_settings settings = lodestone_default_settings();
  settings.signatures = lend_signature;
  settings.signatures_context = signature;
  settings.audit_ms = 5.0;
  settings.policy.full_within = 10.0;
  lodestone_manager* manager = NULL;
  DO(lodestone_create(&settings, &manager));
  DO(lodestone_replace_material(manager, 0, 0.4, 0.5, 1000.0));
  DO(lodestone_add_plane(manager, (lodestone_vec3){0, 0, 1}, 0.0, 0, NULL));
  for (int i = 0; i < 8; ++i) {
    lodestone_body_definition definition = lodestone_default_body(crate);
    definition.state.position = (lodestone_vec3){2.0 * i, 0.0, 1.0 + 0.1 * i};
    definition.state.angular_velocity = (lodestone_vec3){1.0, 0.5 * i, 0.3};
    DO(lodestone_add_body(manager, &definition, NULL));
  }
  look_from(manager, 0.0);
  for (int i = 0; i < 10; ++i) DO(lodestone_step(manager, 1.0 / 60.0, NULL));
  look_from(manager, 1e4);
  for (int i = 0; i < 400; ++i) DO(lodestone_step(manager, 1.0 / 60.0, NULL));
  lodestone_report report;
  lodestone_audit audit;
  DO(lodestone_get_report(manager, &report));
  DO(lodestone_get_audit(manager, &audit));
  within(report.full, 0, 0, "bodies full, far from the viewpoint");
  within(signatures_asked, 1, 100, "times that the caller's signatures were asked for");
  within(audit.bodies, 1, 8, "bodies that the audit compared");
  within(audit.bodies + audit.watched + audit.left_out, 1, 8, "with those that it still watches, and left out");
  that(audit.rest_time_s.full > 0 && audit.rest_time_s.difference_least <= audit.rest_time_s.difference_most && audit.drift_least <= audit.drift_most, "its figures and intervals");
  lodestone_destroy(manager);

  lodestone_body_definition definition = lodestone_default_body(crate);
  definition.level = LODESTONE_CHOOSE_TABLES;
  lodestone_body body;
  DO(lodestone_create(&settings, &manager));
  DO(lodestone_add_plane(manager, (lodestone_vec3){0, 0, 1}, 0.0, 0, NULL));
  definition.state.position = (lodestone_vec3){0.0, 0.0, 0.6};
  definition.state.angular_velocity = (lodestone_vec3){3.0, 2.0, 1.0};
  DO(lodestone_add_body(manager, &definition, &body));
  for (int i = 0; i < 600; ++i) DO(lodestone_step(manager, 1.0 / 60.0, NULL));
  lodestone_state lying;
  DO(lodestone_get_state(manager, body, &lying));
  const double height = lying.position.z, face = height < 0.125 ? 0.1 : height < 0.175 ? 0.15 : 0.2;
  within(height, face - 0.002, face + 0.002, "m, height of a crate at tables on one of its faces, as the default options have it");
  lodestone_destroy(manager);

  settings.signatures_context = NULL;
  DO(lodestone_create(&settings, &manager));
  definition = lodestone_default_body(crate);
  definition.level = LODESTONE_CHOOSE_TABLES;
  DO(lodestone_add_body(manager, &definition, &body));
  refused(lodestone_step(manager, 1.0 / 60.0, NULL), "tables", "a body at tables without a signature");
  DO(lodestone_set_level(manager, body, LODESTONE_CHOOSE_SUPPORT));
  DO(lodestone_step(manager, 1.0 / 60.0, NULL));
  lodestone_destroy(manager);
  lodestone_release_signature(signature);
  lodestone_release_shape(crate);
}

/* ---- A world of the caller's ---- */

static void check_callers_world(void) {
  dInitODE2(0);
  const dWorldID world = dWorldCreate();
  const dSpaceID space = dHashSpaceCreate(NULL);
  dWorldSetGravity(world, 0, 0, -9.81);
  dCreatePlane(space, 0, 0, 1, 0);
  lodestone_manager* manager = NULL;
  refused(lodestone_create_in(NULL, space, NULL, &manager), "world", "no world");
  DO(lodestone_create_in(world, space, NULL, &manager));
  lodestone_shape* ball = NULL;
  DO(lodestone_make_sphere(0.2, &ball));
  lodestone_body_definition definition = lodestone_default_body(ball);
  definition.level = LODESTONE_CHOOSE_FULL;
  definition.state.position.z = 0.5;
  lodestone_body body;
  lodestone_state state;
  DO(lodestone_add_body(manager, &definition, &body));
  lodestone_release_shape(ball);
  for (int i = 0; i < 120; ++i) DO(lodestone_step(manager, 1.0 / 60.0, NULL));
  DO(lodestone_get_state(manager, body, &state));
  within(state.position.z, 0.19, 0.21, "height of a full ball on the caller's plane, m");
  struct dxBody* ode_body = NULL;
  DO(lodestone_get_ode_body(manager, body, &ode_body));
  that(ode_body && dBodyGetWorld(ode_body) == world, "its dBodyID is in the caller's world");
  /* A body of his own, asked for. */
  const dBodyID his = dBodyCreate(world);
  const dGeomID box = dCreateBox(space, 1, 1, 1);
  dGeomSetBody(box, his);
  dBodySetPosition(his, 5, 0, 0.5);
  DO(lodestone_step(manager, 1.0 / 60.0, NULL));
  const lodestone_ray ray = {{5, 0, 5}, {0, 0, -1}, 10.0, 0.0};
  bool met = false;
  lodestone_hit hit;
  DO(lodestone_cast_rays(manager, &ray, 1, NULL, &met, &hit));
  that(met && hit.who.kind == LODESTONE_SIDE_CALLERS && hit.who.callers == his && hit.who.geom == box, "a ray meets a body of the caller's");
  lodestone_query_filter without = lodestone_default_filter();
  without.callers = false;
  DO(lodestone_cast_rays(manager, &ray, 1, &without, &met, &hit));
  that(met && hit.who.callers == NULL && hit.who.geom != box, "and the ground below where they are left out");
  dGeomDestroy(box);
  dBodyDestroy(his);
  /* One without a geom, pushed for the whole of a step. */
  const dBodyID pushed = dBodyCreate(world);
  dBodySetGravityMode(pushed, 0);
  refused(lodestone_include_body(manager, NULL), "body", "null is no body");
  DO(lodestone_include_body(manager, pushed));
  dBodyAddForce(pushed, 60, 0, 0);
  DO(lodestone_step(manager, 1.0 / 60.0, NULL));
  within(dBodyGetLinearVel(pushed)[0], 1.0 - 1e-9, 1.0 + 1e-9, "of 1 kg under 60 N for a step, m/s");
  DO(lodestone_exclude_body(manager, pushed));
  dBodyDestroy(pushed);
  double radius = -1;
  DO(lodestone_get_collision_radius(manager, body, &radius));
  that(radius == 0, "a full body has no sphere");
  /* His own loop. */
  lodestone_report report;
  DO(lodestone_set_state(manager, body, &(lodestone_state){{0, 0, 3}, {1, 0, 0, 0}, {0, 0, 0}, {0, 0, 0}}));
  for (int i = 0; i < 30; ++i) {
    DO(lodestone_before_world_step(manager, 1.0 / 60.0));
    dWorldStep(world, 1.0 / 60.0);
    DO(lodestone_after_world_step(manager, &report));
  }
  DO(lodestone_get_state(manager, body, &state));
  within(state.position.z, 3 - 0.5 * 9.81 * 0.25 - 0.05, 3 - 0.5 * 9.81 * 0.25 + 0.05, "height after half a second of fall in the caller's own loop, m");
  refused(lodestone_after_world_step(manager, NULL), "before_world_step", "an end without a beginning");
  lodestone_destroy(manager);
  dSpaceDestroy(space);
  dWorldDestroy(world);
}

int main(void) {
  that(strlen(lodestone_version()) >= 5, "a version");
  check_a_heap();
  check_signatures_and_audit();
  check_callers_world();
  return failures > 0;
}
