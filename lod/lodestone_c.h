/* Lodestone for C (C11) and for whatever calls C. It does the same as <lodestone/lod/manager.h>, which is the
 * manual, with the same units, ranges and defaults; only what differs is said here.
 *
 * - Results. Every function that can fail returns LODESTONE_OK, or the kind of failure, of which
 *   lodestone_error() then tells more. After LODESTONE_BAD_INPUT nothing has changed, unless the manual says
 *   otherwise (of a divided step, of a replay); after any failure outputs are as they were. No exception
 *   leaves the library.
 * - Pointers. Input must not be null, except where its count is 0 or where null is mentioned. An output may
 *   be null, and is not written then; but the place of a new handle must not be null, nor an array of states,
 *   poses or text to fill.
 * - Lists that a function hands out belong to the manager, and are valid until its next step.
 * - Handles. One thread at a time uses a handle. The caller releases or destroys those that he made.
 * - SI units, unless a name ends in another (`_ms`, `_px`); world frame right-handed. */
#ifndef LODESTONE_C_H
#define LODESTONE_C_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct dxWorld; /* dWorldID is struct dxWorld* */
struct dxSpace;
struct dxBody;
struct dxGeom;

/* Handles. */
typedef struct lodestone_manager lodestone_manager;
typedef struct lodestone_shape lodestone_shape;
typedef struct lodestone_signature lodestone_signature;

/* How a call ended. */
typedef enum lodestone_result {
  LODESTONE_OK = 0,
  LODESTONE_BAD_INPUT = 1, /* an argument or a file cannot be used: InputError */
  LODESTONE_OUT_OF_MEMORY = 2,
  LODESTONE_FAILED = 3 /* anything else; after a SimulationError the manager cannot be stepped */
} lodestone_result;

/* What the last call on this thread that failed had to say; empty before. Never null; valid until the next
 * call on this thread that fails. */
const char* lodestone_error(void);
/* The library's version, as LODESTONE_VERSION_STRING of <lodestone/lod/version.h>. */
const char* lodestone_version(void);
/* From now on `handler` is called with the message of a bug in the library before the process aborts, on the
 * thread that met it. Null: none. */
void lodestone_set_assertion_handler(void (*handler)(void* context, const char* message), void* context);

/* ---- Values ---- */

typedef struct lodestone_vec3 {
  double x, y, z;
} lodestone_vec3;
typedef struct lodestone_quat {
  double w, x, y, z;
} lodestone_quat;
typedef struct lodestone_body {
  uint32_t index, generation;
} lodestone_body; /* an id; null: generation 0 */
/* An id of ground, with the same null. */
typedef struct lodestone_ground {
  uint32_t index, generation;
} lodestone_ground;

/* See RigidState: m, unit quaternion, m/s, rad/s. */
typedef struct lodestone_state {
  lodestone_vec3 position;
  lodestone_quat orientation;
  lodestone_vec3 velocity, angular_velocity;
} lodestone_state;

/* See Rung, and LevelChoice. */
typedef enum lodestone_rung {
  LODESTONE_TABLES = 0,
  LODESTONE_SUPPORT = 1,
  LODESTONE_FULL = 2
} lodestone_rung;
typedef enum lodestone_level_choice {
  LODESTONE_CHOOSE_AUTOMATIC = 0,
  LODESTONE_CHOOSE_FULL = 1,
  LODESTONE_CHOOSE_STATISTICAL = 2,
  LODESTONE_CHOOSE_SUPPORT = 3,
  LODESTONE_CHOOSE_TABLES = 4
} lodestone_level_choice;

/* ---- Shapes: made once, shared by any number of bodies and managers ---- */

/* `sides`: whole edge lengths, m. The name is for messages and for the source of signatures. */
lodestone_result lodestone_make_box(const char* name, lodestone_vec3 sides, lodestone_shape** shape);
lodestone_result lodestone_make_sphere(double radius, lodestone_shape** shape); /* m; its name is "sphere" */
/* `faces`: three indices into `vertices` for each face, counter-clockwise seen from outside: 3 · face_count
 * numbers. See make_shape. */
lodestone_result lodestone_make_mesh(const char* name, const lodestone_vec3* vertices, size_t vertex_count,
                                     const int32_t* faces, size_t face_count, lodestone_shape** shape);
/* An OBJ, PLY, STL, glTF or 3DS file, scaled so that its longest side is `size` m; 0: as it is in the file.
 * The shape's name is `file`. */
lodestone_result lodestone_load_mesh(const char* file, double size, lodestone_shape** shape);
void lodestone_release_shape(lodestone_shape* shape); /* or null; bodies keep what they need */

/* ---- Signatures: what the statistical rungs know of a shape under a contact law ---- */

/* From a file that `lodestone sign` wrote, or from its bytes. */
lodestone_result lodestone_load_signature(const char* file, lodestone_signature** signature);
lodestone_result lodestone_read_signature(const void* bytes, size_t size, lodestone_signature** signature);
/* From the cache, or measured, which takes seconds, and cached. `threads` ≥ 0; 0: all cores. */
lodestone_result lodestone_find_or_measure_signature(const lodestone_shape* shape, double restitution,
                                                     double friction, int32_t threads,
                                                     lodestone_signature** signature);
void lodestone_release_signature(lodestone_signature* signature); /* or null; managers keep what they need */

/* ---- Settings ---- */

/* The policies of <lodestone/lod/policy.h>. */
typedef enum lodestone_policy_kind {
  LODESTONE_POLICY_DISTANCE = 0,
  LODESTONE_POLICY_BUDGET_MS = 1,
  LODESTONE_POLICY_BUDGET_WORK = 2,
  LODESTONE_POLICY_PROJECTED_SIZE = 3,
  LODESTONE_POLICY_ERROR_BUDGET_MS = 4,
  LODESTONE_POLICY_ERROR_BUDGET_WORK = 5
} lodestone_policy_kind;

/* See PolicySettings. Fields of other kinds of policy than `kind` are not looked at. */
typedef struct lodestone_policy {
  lodestone_policy_kind kind;
  double full_within, support_within;     /* m; of LODESTONE_POLICY_DISTANCE */
  double full_above_px, support_above_px; /* of LODESTONE_POLICY_PROJECTED_SIZE */
  double budget;                          /* ms, or work units; of the policies with a budget */
  double hysteresis;
  int32_t min_dwell_frames, max_transitions_per_frame, most_full, most_support;
  double out_of_view_factor, look_ahead_s;
  bool contact_groups_together;
  bool (*visible)(void* context, lodestone_vec3 center, double radius); /* null: whether in any frustum */
  double (*significance)(void* context, lodestone_body body);           /* null: 1 */
  void* context;                                                        /* given to both */
} lodestone_policy;

/* See ManagerSettings::model, and SignatureTiming. */
typedef enum lodestone_model {
  LODESTONE_MODEL_BY_POLICY = 0,
  LODESTONE_MODEL_TABLES = 1,
  LODESTONE_MODEL_SUPPORT = 2
} lodestone_model;
typedef enum lodestone_signature_timing {
  LODESTONE_SIGNATURES_AUTOMATIC = 0,
  LODESTONE_SIGNATURES_IN_STEP = 1,
  LODESTONE_SIGNATURES_IN_BACKGROUND = 2
} lodestone_signature_timing;

/* A lodestone_run_jobs must call task(task_context, 0) … task(task_context, count − 1), each once, in any
 * order and on any threads, and return when all are done. */
typedef void (*lodestone_task)(const void* task_context, int64_t index);
typedef void (*lodestone_run_jobs)(void* context, int64_t count, lodestone_task task,
                                   const void* task_context);

/* See TablesOptions. */
typedef struct lodestone_tables_options {
  bool interpolate, draw_height;
  int32_t radius_update_interval;
  bool rest_poses, nearest_rest_pose, paper_pair_rule, published;
} lodestone_tables_options;

/* See EventSettings. */
typedef struct lodestone_event_settings {
  bool all_bodies;
  double least_speed, least_impulse;
} lodestone_event_settings;

/* See ManagerSettings. */
typedef struct lodestone_settings {
  lodestone_vec3 gravity;
  uint64_t seed;
  int32_t threads, full_substeps;
  bool sleeping;
  double sleep_speed, sleep_time;
  lodestone_model model;
  lodestone_tables_options tables;
  /* Supplies signatures, as SignatureFunction says; null: they are found in the cache or measured. It may
   * return null for none. The handle that it returns must stay valid until it is called again, or the manager
   * is destroyed. */
  const lodestone_signature* (*signatures)(void* context, const char* shape_name, double restitution,
                                           double friction);
  void* signatures_context;
  lodestone_signature_timing signature_timing;
  lodestone_policy policy;
  double audit_ms;
  lodestone_event_settings events;
  lodestone_run_jobs jobs; /* null: oneTBB's threads */
  void* jobs_context;
  /* See ManagerSettings::pair_filter; null: all pairs may meet. */
  bool (*pair_filter)(void* context, lodestone_body first, lodestone_body second);
  void* pair_filter_context;
} lodestone_settings;

/* The defaults of PolicySettings with a DistancePolicy, and of ManagerSettings. */
lodestone_policy lodestone_default_policy(void);
lodestone_settings lodestone_default_settings(void);

/* ---- A manager ---- */

lodestone_result lodestone_create(const lodestone_settings* settings,
                                  lodestone_manager** manager); /* null settings: the defaults */
/* In the caller's world and space (dWorldID, dSpaceID), which must outlive the manager. */
lodestone_result lodestone_create_in(struct dxWorld* world, struct dxSpace* space,
                                     const lodestone_settings* settings, lodestone_manager** manager);
void lodestone_destroy(lodestone_manager* manager); /* or null */

/* Restitution 0 … 1, friction ≥ 0, density > 0 kg/m³. A pair of materials has the lower restitution and
 * √(μ₁ μ₂), unless a law is set for it. Material 0 is there from the start. */
lodestone_result lodestone_add_material(lodestone_manager* manager, double restitution, double friction,
                                        double density, int32_t* material);
lodestone_result lodestone_replace_material(lodestone_manager* manager, int32_t material, double restitution,
                                            double friction, double density);
lodestone_result lodestone_set_contact_law(lodestone_manager* manager, int32_t first, int32_t second,
                                           double restitution, double friction);

lodestone_result lodestone_add_plane(lodestone_manager* manager, lodestone_vec3 normal, double offset,
                                     int32_t material, lodestone_ground* ground);
lodestone_result lodestone_add_static_box(lodestone_manager* manager, lodestone_vec3 sides,
                                          lodestone_vec3 position, lodestone_quat orientation,
                                          int32_t material, lodestone_ground* ground);
lodestone_result lodestone_add_static_mesh(lodestone_manager* manager, const lodestone_vec3* vertices,
                                           size_t vertex_count, const int32_t* faces, size_t face_count,
                                           int32_t material, lodestone_ground* ground);
lodestone_result lodestone_move_ground(lodestone_manager* manager, lodestone_ground ground,
                                       const lodestone_state* state);
lodestone_result lodestone_remove_ground(lodestone_manager* manager, lodestone_ground ground);
bool lodestone_is_valid_ground(const lodestone_manager* manager,
                               lodestone_ground ground); /* false if the manager is null */
/* Only in a caller's world. */
lodestone_result lodestone_include_body(lodestone_manager* manager, struct dxBody* ode_body);
lodestone_result lodestone_exclude_body(lodestone_manager* manager, struct dxBody* ode_body);

lodestone_result lodestone_set_policy(lodestone_manager* manager, const lodestone_policy* policy);
/* See Viewpoint. */
typedef struct lodestone_viewpoint {
  lodestone_vec3 position, direction, up; /* a direction of 0 sees all around */
  double vertical_fov_rad, height_px, aspect;
} lodestone_viewpoint;
lodestone_viewpoint lodestone_default_viewpoint(lodestone_vec3 position); /* sees all around */
lodestone_result lodestone_set_viewpoints(lodestone_manager* manager, const lodestone_viewpoint* viewpoints,
                                          size_t count);
lodestone_result lodestone_set_gravity(lodestone_manager* manager, lodestone_vec3 gravity);
lodestone_result lodestone_get_gravity(const lodestone_manager* manager, lodestone_vec3* gravity);
lodestone_result lodestone_set_full_substeps(lodestone_manager* manager, int32_t substeps);
lodestone_result lodestone_set_threads(lodestone_manager* manager, int32_t threads);
lodestone_result lodestone_set_event_settings(lodestone_manager* manager,
                                              const lodestone_event_settings* settings);

/* ---- Bodies ---- */

/* See BodyProperties. */
typedef struct lodestone_properties {
  uint32_t category, collide;
  bool gravity, kinematic, allow_sleep;
  double linear_damping, angular_damping, max_angular_speed;
} lodestone_properties;

/* See BodyDefinition. */
typedef struct lodestone_body_definition {
  const lodestone_shape* shape;
  lodestone_state state;
  int32_t material;
  double mass; /* kg; 0: the material's density times the shape's volume */
  lodestone_level_choice level;
  lodestone_rung least_rung, greatest_rung;
  double importance;
  lodestone_properties properties;
  uintptr_t user_data;
  bool events;
} lodestone_body_definition;

lodestone_properties lodestone_default_properties(void);
lodestone_body_definition lodestone_default_body(const lodestone_shape* shape); /* at the origin, at rest */

lodestone_result lodestone_add_body(lodestone_manager* manager, const lodestone_body_definition* definition,
                                    lodestone_body* body);
lodestone_result lodestone_remove_body(lodestone_manager* manager, lodestone_body body);
bool lodestone_is_valid(const lodestone_manager* manager,
                        lodestone_body body); /* false if the manager is null */

lodestone_result lodestone_set_level(lodestone_manager* manager, lodestone_body body,
                                     lodestone_level_choice choice);
lodestone_result lodestone_set_rung_range(lodestone_manager* manager, lodestone_body body,
                                          lodestone_rung least, lodestone_rung greatest);
lodestone_result lodestone_set_importance(lodestone_manager* manager, lodestone_body body, double importance);
lodestone_result lodestone_set_state(lodestone_manager* manager, lodestone_body body,
                                     const lodestone_state* state);
lodestone_result lodestone_set_user_data(lodestone_manager* manager, lodestone_body body,
                                         uintptr_t user_data);
lodestone_result lodestone_set_events(lodestone_manager* manager, lodestone_body body, bool events);
lodestone_result lodestone_set_properties(lodestone_manager* manager, lodestone_body body,
                                          const lodestone_properties* properties);
lodestone_result lodestone_add_force(lodestone_manager* manager, lodestone_body body, lodestone_vec3 force,
                                     lodestone_vec3 torque);
lodestone_result lodestone_add_force_at(lodestone_manager* manager, lodestone_body body, lodestone_vec3 force,
                                        lodestone_vec3 point);
lodestone_result lodestone_add_impulse(lodestone_manager* manager, lodestone_body body,
                                       lodestone_vec3 impulse, lodestone_vec3 point);
lodestone_result lodestone_sleep(lodestone_manager* manager, lodestone_body body);
lodestone_result lodestone_wake(lodestone_manager* manager, lodestone_body body);

/* An id of bodies that change rung together; null: generation 0. */
typedef struct lodestone_group {
  uint32_t index, generation;
} lodestone_group;
/* The two functions are those of GroupJoints: both, or both null. */
lodestone_result lodestone_make_group(lodestone_manager* manager, const lodestone_body* bodies, size_t count,
                                      void (*before_demotion)(void* context, lodestone_group group),
                                      void (*after_promotion)(void* context, lodestone_group group),
                                      void* context, lodestone_group* group);
lodestone_result lodestone_dissolve_group(lodestone_manager* manager, lodestone_group group);
bool lodestone_is_valid_group(const lodestone_manager* manager,
                              lodestone_group group); /* false if the manager is null */

lodestone_result lodestone_get_state(const lodestone_manager* manager, lodestone_body body,
                                     lodestone_state* state);
lodestone_result lodestone_get_mass(const lodestone_manager* manager, lodestone_body body, double* mass);
lodestone_result lodestone_get_user_data(const lodestone_manager* manager, lodestone_body body,
                                         uintptr_t* user_data);
lodestone_result lodestone_get_properties(const lodestone_manager* manager, lodestone_body body,
                                          lodestone_properties* properties);
lodestone_result lodestone_get_rung(const lodestone_manager* manager, lodestone_body body,
                                    lodestone_rung* rung);
lodestone_result lodestone_is_asleep(const lodestone_manager* manager, lodestone_body body, bool* asleep);
lodestone_result lodestone_get_collision_radius(const lodestone_manager* manager, lodestone_body body,
                                                double* radius);
/* The dBodyID; null unless the body is full. */
lodestone_result lodestone_get_ode_body(const lodestone_manager* manager, lodestone_body body,
                                        struct dxBody** ode_body);
/* See Rule. */
typedef enum lodestone_rule {
  LODESTONE_RULE_FORCED = 0,
  LODESTONE_RULE_NEAR = 1,
  LODESTONE_RULE_FAR = 2,
  LODESTONE_RULE_WITHIN_HYSTERESIS = 3,
  LODESTONE_RULE_DWELL = 4,
  LODESTONE_RULE_QUEUED = 5,
  LODESTONE_RULE_OVER_BUDGET = 6,
  LODESTONE_RULE_IN_BUDGET = 7,
  LODESTONE_RULE_MOST_REACHED = 8,
  LODESTONE_RULE_OVERLAP_PUT_OFF = 9,
  LODESTONE_RULE_SIGNATURE_PENDING = 10,
  LODESTONE_RULE_RUNG_RANGE = 11,
  LODESTONE_RULE_OUT_OF_VIEW = 12,
  LODESTONE_RULE_LOOK_AHEAD = 13,
  LODESTONE_RULE_JOINED = 14,
  LODESTONE_RULE_CARRIES_FULL = 15,
  LODESTONE_RULE_PAUSED = 16
} lodestone_rule;

/* Why a body has its rung; see Why. */
typedef struct lodestone_reason {
  lodestone_rung rung;
  lodestone_rule rule;
  bool placed, in_view;
  double distance_m, pixels, predicted_error, predicted_error_pixels, cost_work, cost_ms;
  int32_t dwell_left_frames;
  lodestone_group group;
} lodestone_reason;
lodestone_result lodestone_explain(const lodestone_manager* manager, lodestone_body body,
                                   lodestone_reason* reason);
/* Writes the sentence of Manager::why to `text`, with a final zero, cut to `size` bytes in all; nothing if
 * `size` is 0. `length` becomes that of the whole sentence without the zero. */
lodestone_result lodestone_why(const lodestone_manager* manager, lodestone_body body, char* text, size_t size,
                               size_t* length);

/* As many states as bodies. */
lodestone_result lodestone_read_states(const lodestone_manager* manager, const lodestone_body* bodies,
                                       size_t count, lodestone_state* states);
/* Three floats for each body's position (m), and four for its orientation, w first. */
lodestone_result lodestone_read_poses(const lodestone_manager* manager, const lodestone_body* bodies,
                                      size_t count, float* positions_xyz, float* orientations_wxyz);

/* ---- A step ---- */

/* Wall time of the stages of the last step, ms; see StageTimes. */
typedef struct lodestone_stage_times {
  double choose_ms, transfer_ms, flight_ms, broad_phase_ms, pairs_ms, crowd_ms, rest_ms, cross_level_ms,
      full_ms, total_ms;
} lodestone_stage_times;

/* Counts since the manager was made; see Counters. */
typedef struct lodestone_counters {
  int64_t ode_bodies_created, trimeshes_built, signatures_loaded, pair_phases, ode_messages, contacts_dropped,
      states_recovered, full_quick_steps, full_swallowed, full_passes_prevented, full_uneven_contacts,
      energy_clamps, table_extrapolations, levels_considered, promotions_put_off, divided_steps,
      bodies_held_back;
} lodestone_counters;

/* See RungCost. */
typedef struct lodestone_rung_cost {
  double predicted_ms, measured_ms, work;
} lodestone_rung_cost;

/* See StepReport. */
typedef struct lodestone_report {
  int64_t step;
  double dt_s;
  int32_t full, support, tables, asleep, promotions, demotions, contacts;
  lodestone_stage_times times;
  lodestone_rung_cost cost[3]; /* by lodestone_rung */
  double predicted_ms, measured_ms, predicted_error_pixels;
  lodestone_counters counters;
} lodestone_report;

/* What the audit has found since the manager was made (lodestone_settings.audit_ms); see AuditReport. From
 * `…_least` to `…_most` are 95 % intervals. */
typedef struct lodestone_audit_figure {
  double full, demoted, deviation, difference_least, difference_most;
} lodestone_audit_figure;
typedef struct lodestone_audit {
  int32_t bodies, watched, left_out;
  lodestone_audit_figure rest_time_s, distance_m, rest_height;
  double drift, drift_least, drift_most, spent_ms;
} lodestone_audit;

lodestone_result lodestone_step(lodestone_manager* manager, double dt, lodestone_report* report);
/* Before and after the caller's own dWorldStep, in place of lodestone_step; only in a caller's world. */
lodestone_result lodestone_before_world_step(lodestone_manager* manager, double dt);
lodestone_result lodestone_after_world_step(lodestone_manager* manager, lodestone_report* report);
lodestone_result lodestone_get_report(const lodestone_manager* manager, lodestone_report* report);
lodestone_result lodestone_get_audit(const lodestone_manager* manager, lodestone_audit* audit);
lodestone_result lodestone_body_count(const lodestone_manager* manager, size_t* count);
lodestone_result lodestone_state_hash(const lodestone_manager* manager, uint64_t* hash);

/* See RungChange, ContactPhase, ContactSide and ContactEvent. */
typedef struct lodestone_rung_change {
  lodestone_body body;
  lodestone_rung from, to;
} lodestone_rung_change;

typedef enum lodestone_contact_phase {
  LODESTONE_CONTACT_BEGIN = 0,
  LODESTONE_CONTACT_HIT = 1,
  LODESTONE_CONTACT_END = 2
} lodestone_contact_phase;
typedef enum lodestone_contact_kind {
  LODESTONE_SIDE_BODY = 0,
  LODESTONE_SIDE_GROUND = 1,
  LODESTONE_SIDE_CALLERS = 2
} lodestone_contact_kind;

typedef struct lodestone_contact_side {
  lodestone_contact_kind kind;
  lodestone_body body;
  lodestone_ground ground;
  struct dxGeom* geom;    /* of the caller's ground; in a query also of his dynamic body */
  struct dxBody* callers; /* the caller's dynamic body */
  int32_t material;
} lodestone_contact_side;

typedef struct lodestone_contact_event {
  lodestone_contact_phase phase;
  lodestone_contact_side first, second;
  lodestone_vec3 point, normal;
  double impulse, speed;
} lodestone_contact_event;

/* What the last step did, in lists. */
lodestone_result lodestone_moved(const lodestone_manager* manager, const lodestone_body** bodies,
                                 size_t* count);
lodestone_result lodestone_fell_asleep(const lodestone_manager* manager, const lodestone_body** bodies,
                                       size_t* count);
lodestone_result lodestone_woke(const lodestone_manager* manager, const lodestone_body** bodies,
                                size_t* count);
lodestone_result lodestone_rung_changes(lodestone_manager* manager, const lodestone_rung_change** changes,
                                        size_t* count);
lodestone_result lodestone_contact_events(lodestone_manager* manager, const lodestone_contact_event** events,
                                          size_t* count);

/* ---- Queries ---- */

/* See QueryFilter. */
typedef struct lodestone_query_filter {
  uint32_t categories;
  bool bodies, ground, callers; /* the manager's bodies, ground, the caller's dynamic bodies */
  lodestone_body except;
} lodestone_query_filter;

/* See Ray and SphereSweep. */
typedef struct lodestone_ray {
  lodestone_vec3 from, direction;
  double length, radius; /* m; radius 0: a ray; > 0: a sphere that moves along it */
} lodestone_ray;

/* See BoxVolume and SphereVolume. */
typedef struct lodestone_volume {
  lodestone_vec3 sides; /* m, of a box; all 0: it is a sphere */
  double radius;        /* m, of a sphere; not looked at for a box */
  lodestone_vec3 position;
  lodestone_quat orientation; /* of a box */
} lodestone_volume;

/* See QueryHit. */
typedef struct lodestone_hit {
  lodestone_contact_side who;
  lodestone_vec3 point, normal;
  double distance;
} lodestone_hit;

lodestone_query_filter lodestone_default_filter(void);
/* The nearest hit of each ray or sphere: `met[i]` tells whether there is one, and `hits[i]` is written only
 * then. Both have `count` places. A null filter is the default one, here and below. */
lodestone_result lodestone_cast_rays(const lodestone_manager* manager, const lodestone_ray* rays,
                                     size_t count, const lodestone_query_filter* filter, bool* met,
                                     lodestone_hit* hits);
/* Calls `found` with all that each ray or sphere meets, ray by ray and by distance, on the calling thread;
 * `ray` is the index in `rays`. The hit is valid during the call. */
lodestone_result lodestone_cast_rays_through(const lodestone_manager* manager, const lodestone_ray* rays,
                                             size_t count, const lodestone_query_filter* filter,
                                             void (*found)(void* context, size_t ray,
                                                           const lodestone_hit* hit),
                                             void* context);
/* The same with each body and piece of ground that a volume touches, contains or lies in. */
lodestone_result lodestone_overlap(const lodestone_manager* manager, const lodestone_volume* volumes,
                                   size_t count, const lodestone_query_filter* filter,
                                   void (*found)(void* context, size_t volume, const lodestone_hit* hit),
                                   void* context);

/* ---- Snapshots and recordings ---- */

/* Writes a snapshot to `buffer`, which has `capacity` bytes, and its length to `size`; with a null buffer
 * only its length. LODESTONE_BAD_INPUT if the buffer is too small. */
lodestone_result lodestone_snapshot(const lodestone_manager* manager, void* buffer, size_t capacity,
                                    size_t* size);
lodestone_result lodestone_restore(lodestone_manager* manager, const void* snapshot, size_t size,
                                   const lodestone_shape* const* shapes, size_t shape_count);
/* `write` is called with the next bytes of the recording, valid during the call; null: ends the recording. */
lodestone_result lodestone_set_record(lodestone_manager* manager,
                                      void (*write)(void* context, const void* bytes, size_t size),
                                      void* context);

/* See ReplayResult. */
typedef struct lodestone_replay_result {
  int32_t steps;
  bool same;
  lodestone_body body;
  const char* text; /* the result in words, valid until the manager's next replay */
} lodestone_replay_result;
lodestone_result lodestone_replay(lodestone_manager* manager, const void* recording, size_t size,
                                  const lodestone_shape* const* shapes, size_t shape_count,
                                  lodestone_replay_result* result);

/* ---- Hooks ---- */

/* See <lodestone/lod/hooks.h>. */
typedef enum lodestone_log_level {
  LODESTONE_LOG_INFO = 0,
  LODESTONE_LOG_WARNING = 1,
  LODESTONE_LOG_ERROR = 2
} lodestone_log_level;
typedef struct lodestone_color {
  float red, green, blue;
} lodestone_color;

/* A null function: none. The text of a log is valid during the call. */
lodestone_result lodestone_set_log(lodestone_manager* manager,
                                   void (*log)(void* context, lodestone_log_level level, const char* text),
                                   void* context);
lodestone_result lodestone_set_profile(lodestone_manager* manager,
                                       void (*begin)(void* context, const char* zone),
                                       void (*end)(void* context, const char* zone), void* context);

/* See DrawSettings. */
typedef struct lodestone_draw_settings {
  bool bodies, contacts, bounds;
  lodestone_color colors[3]; /* by lodestone_rung */
  lodestone_color contact_color, bounds_color;
  double normal_length;
} lodestone_draw_settings;
lodestone_draw_settings lodestone_default_draw_settings(void);
/* What has a null function is not drawn. Null settings: the defaults. */
lodestone_result lodestone_draw(const lodestone_manager* manager,
                                void (*line)(void* context, lodestone_vec3 from, lodestone_vec3 to,
                                             lodestone_color color),
                                void (*point)(void* context, lodestone_vec3 at, lodestone_color color),
                                void* context, const lodestone_draw_settings* settings);

#ifdef __cplusplus
}
#endif

#endif
