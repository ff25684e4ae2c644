/* Lodestone for C (C11) and for whatever calls C: the same as <lodestone/lod/manager.h>, which is the manual;
 * here is only what differs.
 *
 * Every function that can fail returns LODESTONE_OK or why it failed, lodestone_error() says it in words;
 * nothing has changed then, and what it would have given is left alone. No exception leaves the library. SI
 * units, world frame right-handed. Pointers to input may be null only where their count is 0 or it is said;
 * an output of one thing that is null is not given. Lists that a function hands out belong to the manager and
 * last until its next step. Handles are used by one thread at a time. */
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

typedef struct lodestone_manager lodestone_manager;
typedef struct lodestone_shape lodestone_shape;
typedef struct lodestone_signature lodestone_signature;

typedef enum lodestone_result {
  LODESTONE_OK = 0,
  LODESTONE_BAD_INPUT = 1,
  LODESTONE_OUT_OF_MEMORY = 2,
  LODESTONE_FAILED = 3
} lodestone_result;

/* Why the last call on this thread that failed did so. Never null. */
const char* lodestone_error(void);
/* Of the library, LODESTONE_VERSION_STRING of <lodestone/lod/version.h>. */
const char* lodestone_version(void);
/* Is called with the message of a bug of the library's before the process aborts, on the thread that met it.
 * Null: none. */
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
} lodestone_body; /* null: generation 0 */
typedef struct lodestone_ground {
  uint32_t index, generation;
} lodestone_ground;

typedef struct lodestone_state {
  lodestone_vec3 position;
  lodestone_quat orientation;
  lodestone_vec3 velocity, angular_velocity;
} lodestone_state;

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

lodestone_result lodestone_make_box(const char* name, lodestone_vec3 sides, lodestone_shape** shape);
lodestone_result lodestone_make_sphere(double radius, lodestone_shape** shape);
/* `faces`: three indices each, counter-clockwise from outside. */
lodestone_result lodestone_make_mesh(const char* name, const lodestone_vec3* vertices, size_t vertex_count,
                                     const int32_t* faces, size_t face_count, lodestone_shape** shape);
/* OBJ, PLY, STL, glTF or 3DS; its longest side becomes `size` m, 0: as it is. */
lodestone_result lodestone_load_mesh(const char* file, double size, lodestone_shape** shape);
void lodestone_release_shape(lodestone_shape* shape); /* null too; bodies keep what they need */

/* ---- Signatures: what the statistical rungs know of a shape under a contact law ---- */

/* A file of `lodestone sign`, or its bytes. */
lodestone_result lodestone_load_signature(const char* file, lodestone_signature** signature);
lodestone_result lodestone_read_signature(const void* bytes, size_t size, lodestone_signature** signature);
/* From the cache, or measured, which takes seconds, and cached; `threads` 0: all cores. */
lodestone_result lodestone_find_or_measure_signature(const lodestone_shape* shape, double restitution,
                                                     double friction, int32_t threads,
                                                     lodestone_signature** signature);
void lodestone_release_signature(lodestone_signature* signature); /* null too; managers keep what they need */

/* ---- Settings ---- */

typedef enum lodestone_policy_kind {
  LODESTONE_POLICY_DISTANCE = 0,
  LODESTONE_POLICY_BUDGET_MS = 1,
  LODESTONE_POLICY_BUDGET_WORK = 2,
  LODESTONE_POLICY_PROJECTED_SIZE = 3,
  LODESTONE_POLICY_ERROR_BUDGET_MS = 4,
  LODESTONE_POLICY_ERROR_BUDGET_WORK = 5
} lodestone_policy_kind;

typedef struct lodestone_policy {
  lodestone_policy_kind kind;
  double full_within, support_within;     /* m, LODESTONE_POLICY_DISTANCE */
  double full_above_px, support_above_px; /* LODESTONE_POLICY_PROJECTED_SIZE */
  double budget;                          /* ms or work units */
  double hysteresis;
  int32_t min_dwell_frames, max_transitions_per_frame, most_full, most_support;
  double out_of_view_factor, look_ahead_s;
  bool contact_groups_together;
  bool (*visible)(void* context, lodestone_vec3 center, double radius); /* null: by the frusta */
  double (*significance)(void* context, lodestone_body body);           /* null: 1 */
  void* context;                                                        /* of both */
} lodestone_policy;

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

/* Calls task(task_context, 0) … task(task_context, count − 1), each once, on any threads, and returns when
 * all are done. */
typedef void (*lodestone_task)(const void* task_context, int64_t index);
typedef void (*lodestone_run_jobs)(void* context, int64_t count, lodestone_task task,
                                   const void* task_context);

/* Options of `tables`; see TablesOptions. */
typedef struct lodestone_tables_options {
  bool interpolate, draw_height;
  int32_t radius_update_interval;
  bool rest_poses, nearest_rest_pose, paper_pair_rule, published;
} lodestone_tables_options;

typedef struct lodestone_event_settings {
  bool all_bodies;
  double least_speed, least_impulse;
} lodestone_event_settings;

typedef struct lodestone_settings {
  lodestone_vec3 gravity;
  uint64_t seed;
  int32_t threads, full_substeps;
  bool sleeping;
  double sleep_speed, sleep_time;
  lodestone_model model;
  lodestone_tables_options tables;
  /* Null: found in the cache or measured. Else asked when a first body of a shape and law needs its
   * signature, which is lent until it returns; null: there is none, and a step in which a body of the shape
   * would be at `tables` is LODESTONE_BAD_INPUT. See ManagerSettings::signatures. */
  const lodestone_signature* (*signatures)(void* context, const char* shape_name, double restitution,
                                           double friction);
  void* signatures_context;
  lodestone_signature_timing signature_timing;
  lodestone_policy policy;
  double audit_ms;
  lodestone_event_settings events;
  lodestone_run_jobs jobs; /* null: oneTBB's */
  void* jobs_context;
  /* Null: all pairs may meet. See ManagerSettings::pair_filter. */
  bool (*pair_filter)(void* context, lodestone_body first, lodestone_body second);
  void* pair_filter_context;
} lodestone_settings;

lodestone_policy lodestone_default_policy(void);
lodestone_settings lodestone_default_settings(void);

/* ---- A manager ---- */

lodestone_result lodestone_create(const lodestone_settings* settings,
                                  lodestone_manager** manager); /* null settings: the defaults */
/* On the caller's world and space (dWorldID, dSpaceID), which must outlive it. */
lodestone_result lodestone_create_in(struct dxWorld* world, struct dxSpace* space,
                                     const lodestone_settings* settings, lodestone_manager** manager);
void lodestone_destroy(lodestone_manager* manager); /* null too */

/* Of a pair of materials the lower restitution and √(μ₁ μ₂) count unless a law is set. Material 0 is there
 * from the start. */
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
                               lodestone_ground ground); /* of a null manager none is */
/* In a caller's world. */
lodestone_result lodestone_include_body(lodestone_manager* manager, struct dxBody* ode_body);
lodestone_result lodestone_exclude_body(lodestone_manager* manager, struct dxBody* ode_body);

lodestone_result lodestone_set_policy(lodestone_manager* manager, const lodestone_policy* policy);
typedef struct lodestone_viewpoint {
  lodestone_vec3 position, direction, up; /* direction zero: it sees all around */
  double vertical_fov_rad, height_px, aspect;
} lodestone_viewpoint;
lodestone_viewpoint lodestone_default_viewpoint(lodestone_vec3 position);
lodestone_result lodestone_set_viewpoints(lodestone_manager* manager, const lodestone_viewpoint* viewpoints,
                                          size_t count);
lodestone_result lodestone_set_gravity(lodestone_manager* manager, lodestone_vec3 gravity);
lodestone_result lodestone_get_gravity(const lodestone_manager* manager, lodestone_vec3* gravity);
lodestone_result lodestone_set_full_substeps(lodestone_manager* manager, int32_t substeps);
lodestone_result lodestone_set_threads(lodestone_manager* manager, int32_t threads);
lodestone_result lodestone_set_event_settings(lodestone_manager* manager,
                                              const lodestone_event_settings* settings);

/* ---- Bodies ---- */

typedef struct lodestone_properties {
  uint32_t category, collide;
  bool gravity, kinematic, allow_sleep;
  double linear_damping, angular_damping, max_angular_speed;
} lodestone_properties;

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
                        lodestone_body body); /* of a null manager none is */

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

/* Bodies that change rung together. Null functions: none of its joints may be taken off; see GroupJoints. */
typedef struct lodestone_group {
  uint32_t index, generation;
} lodestone_group;
lodestone_result lodestone_make_group(lodestone_manager* manager, const lodestone_body* bodies, size_t count,
                                      void (*before_demotion)(void* context, lodestone_group group),
                                      void (*after_promotion)(void* context, lodestone_group group),
                                      void* context, lodestone_group* group);
lodestone_result lodestone_dissolve_group(lodestone_manager* manager, lodestone_group group);
bool lodestone_is_valid_group(const lodestone_manager* manager,
                              lodestone_group group); /* of a null manager none is */

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
/* Null unless it is full. */
lodestone_result lodestone_get_ode_body(const lodestone_manager* manager, lodestone_body body,
                                        struct dxBody** ode_body);
/* What decided a body's rung; see Rule. */
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
  LODESTONE_RULE_CARRIES_FULL = 15
} lodestone_rule;

/* Why it has its rung; see Why. `in_view` and what is about pictures is as without viewpoints where there is
 * none. */
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
/* The text with its final zero, cut to `size`; the whole length without the zero into `length`. */
lodestone_result lodestone_why(const lodestone_manager* manager, lodestone_body body, char* text, size_t size,
                               size_t* length);

lodestone_result lodestone_read_states(const lodestone_manager* manager, const lodestone_body* bodies,
                                       size_t count, lodestone_state* states);
/* Three floats and four (w first) for each body. */
lodestone_result lodestone_read_poses(const lodestone_manager* manager, const lodestone_body* bodies,
                                      size_t count, float* positions_xyz, float* orientations_wxyz);

/* ---- A step ---- */

/* Wall time of the stages of the last step, ms; see StageTimes. */
typedef struct lodestone_stage_times {
  double choose_ms, transfer_ms, flight_ms, broad_phase_ms, pairs_ms, crowd_ms, rest_ms, cross_level_ms,
      full_ms, total_ms;
} lodestone_stage_times;

/* Since the manager was made; see Counters. */
typedef struct lodestone_counters {
  int64_t ode_bodies_created, trimeshes_built, signatures_loaded, pair_phases, ode_messages, contacts_dropped,
      states_recovered, full_quick_steps, full_swallowed, full_passes_prevented, full_uneven_contacts,
      energy_clamps, table_extrapolations, levels_considered, promotions_put_off, divided_steps,
      bodies_held_back;
} lodestone_counters;

typedef struct lodestone_rung_cost {
  double predicted_ms, measured_ms, work;
} lodestone_rung_cost;

typedef struct lodestone_report {
  int64_t step;
  double dt_s;
  int32_t full, support, tables, asleep, promotions, demotions, contacts;
  lodestone_stage_times times;
  lodestone_rung_cost cost[3]; /* by lodestone_rung */
  double predicted_ms, measured_ms, predicted_error_pixels;
  lodestone_counters counters;
} lodestone_report;

/* What the audit has found since the manager was made (lodestone_settings.audit_ms); see AuditReport.
 * Intervals are of 95 %. */
typedef struct lodestone_audit_figure {
  double full, demoted, deviation, difference_least, difference_most;
} lodestone_audit_figure;
typedef struct lodestone_audit {
  int32_t bodies, watched, left_out;
  lodestone_audit_figure rest_time_s, distance_m, rest_height;
  double drift, drift_least, drift_most, spent_ms;
} lodestone_audit;

lodestone_result lodestone_step(lodestone_manager* manager, double dt, lodestone_report* report);
/* Around the caller's own dWorldStep, on his world alone; both in place of lodestone_step. */
lodestone_result lodestone_before_world_step(lodestone_manager* manager, double dt);
lodestone_result lodestone_after_world_step(lodestone_manager* manager, lodestone_report* report);
lodestone_result lodestone_get_report(const lodestone_manager* manager, lodestone_report* report);
lodestone_result lodestone_get_audit(const lodestone_manager* manager, lodestone_audit* audit);
lodestone_result lodestone_body_count(const lodestone_manager* manager, size_t* count);
lodestone_result lodestone_state_hash(const lodestone_manager* manager, uint64_t* hash);

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
  struct dxGeom* geom;    /* of the caller's ground; of his bodies where a query meets them */
  struct dxBody* callers; /* a dynamic body of the caller's */
  int32_t material;
} lodestone_contact_side;

typedef struct lodestone_contact_event {
  lodestone_contact_phase phase;
  lodestone_contact_side first, second;
  lodestone_vec3 point, normal;
  double impulse, speed;
} lodestone_contact_event;

/* What the last step did. */
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

typedef struct lodestone_query_filter {
  uint32_t categories;
  bool bodies, ground, callers; /* the manager's, ground, dynamic bodies of the caller's */
  lodestone_body except;
} lodestone_query_filter;

typedef struct lodestone_ray {
  lodestone_vec3 from, direction;
  double length, radius; /* radius 0: a ray; else a sphere that is swept along it */
} lodestone_ray;

typedef struct lodestone_volume {
  lodestone_vec3 sides; /* of a box; of a sphere all zero */
  double radius;        /* of a sphere */
  lodestone_vec3 position;
  lodestone_quat orientation;
} lodestone_volume;

typedef struct lodestone_hit {
  lodestone_contact_side who;
  lodestone_vec3 point, normal;
  double distance;
} lodestone_hit;

lodestone_query_filter lodestone_default_filter(void);
/* Of each ray or sphere the nearest: `met[i]` says whether there is one, `hits[i]` what. Null filter: the
 * default. */
lodestone_result lodestone_cast_rays(const lodestone_manager* manager, const lodestone_ray* rays,
                                     size_t count, const lodestone_query_filter* filter, bool* met,
                                     lodestone_hit* hits);
/* Calls `found` with all that each ray or sphere meets, by distance, ray by ray. */
lodestone_result lodestone_cast_rays_through(const lodestone_manager* manager, const lodestone_ray* rays,
                                             size_t count, const lodestone_query_filter* filter,
                                             void (*found)(void* context, size_t ray,
                                                           const lodestone_hit* hit),
                                             void* context);
/* Calls `found` with each body and piece of ground that the volumes touch, volume by volume. */
lodestone_result lodestone_overlap(const lodestone_manager* manager, const lodestone_volume* volumes,
                                   size_t count, const lodestone_query_filter* filter,
                                   void (*found)(void* context, size_t volume, const lodestone_hit* hit),
                                   void* context);

/* ---- Snapshots and recordings ---- */

/* Writes a snapshot of at most `capacity` bytes; its length into `size`. With a null buffer only that; a
 * buffer too small is LODESTONE_BAD_INPUT. */
lodestone_result lodestone_snapshot(const lodestone_manager* manager, void* buffer, size_t capacity,
                                    size_t* size);
lodestone_result lodestone_restore(lodestone_manager* manager, const void* snapshot, size_t size,
                                   const lodestone_shape* const* shapes, size_t shape_count);
/* Null function: no more. */
lodestone_result lodestone_set_record(lodestone_manager* manager,
                                      void (*write)(void* context, const void* bytes, size_t size),
                                      void* context);

typedef struct lodestone_replay_result {
  int32_t steps;
  bool same;
  lodestone_body body;
  const char* text; /* the same in words, until the manager's next replay */
} lodestone_replay_result;
lodestone_result lodestone_replay(lodestone_manager* manager, const void* recording, size_t size,
                                  const lodestone_shape* const* shapes, size_t shape_count,
                                  lodestone_replay_result* result);

/* ---- Hooks ---- */

typedef enum lodestone_log_level {
  LODESTONE_LOG_INFO = 0,
  LODESTONE_LOG_WARNING = 1,
  LODESTONE_LOG_ERROR = 2
} lodestone_log_level;
typedef struct lodestone_color {
  float red, green, blue;
} lodestone_color;

/* Null function: none. The text lasts during the call. */
lodestone_result lodestone_set_log(lodestone_manager* manager,
                                   void (*log)(void* context, lodestone_log_level level, const char* text),
                                   void* context);
lodestone_result lodestone_set_profile(lodestone_manager* manager,
                                       void (*begin)(void* context, const char* zone),
                                       void (*end)(void* context, const char* zone), void* context);

typedef struct lodestone_draw_settings {
  bool bodies, contacts, bounds;
  lodestone_color colors[3]; /* by lodestone_rung */
  lodestone_color contact_color, bounds_color;
  double normal_length;
} lodestone_draw_settings;
lodestone_draw_settings lodestone_default_draw_settings(void);
/* Null functions: these are left out. Null settings: the defaults. */
lodestone_result lodestone_draw(const lodestone_manager* manager,
                                void (*line)(void* context, lodestone_vec3 from, lodestone_vec3 to,
                                             lodestone_color color),
                                void (*point)(void* context, lodestone_vec3 at, lodestone_color color),
                                void* context, const lodestone_draw_settings* settings);

#ifdef __cplusplus
}
#endif

#endif
