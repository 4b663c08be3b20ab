// Tests skinned vertices against values computed by hand.
#include "gltf_builder.h"
#include "scene/core/affine.h"
#include "test.h"

static bool near3(const float *a, double x, double y, double z)
{
    return fabs((double)a[0] - x) < 1e-6 && fabs((double)a[1] - y) < 1e-6 &&
           fabs((double)a[2] - z) < 1e-6;
}

// The parts of the file that a test sets; zero means the default.
struct skin_file {
    const char *nodes, *skin, *attributes, *rest;
    const double (*place)[4];
    const double *seconds;
};

// Makes the accessors: 0 positions, 1 normals, 2 tangents, 3 and 4 inverse bind matrices of two
// joints (the identity, and a translation by -1 along X), 5 joints, 6 weights, 7 joints, 8 weights.
static struct gltf_builder with_skin(void)
{
    struct gltf_builder b = {0};
    const uint8_t first[3][4] = {{0, 1}, {0, 1}, {0, 1}};
    const uint16_t second[3][4] = {{1}, {0, 0, 1}, {0}};
    const uint16_t weights[3][4] = {{0}, {0, 0, 32768}, {0}};
    BUILDER_FLOATS(&b, "VEC3", 3, 0, 0, 0, 1, 0, 0, 2, 1, 0);
    BUILDER_FLOATS(&b, "VEC3", 3, 0, 0, 1, 0, 1, 0, 1, 0, 0);
    BUILDER_FLOATS(&b, "VEC4", 3, 1, 0, 0, 1, 1, 0, 0, 1, 0, 1, 0, -1);
    BUILDER_FLOATS(&b, "MAT4", 2, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, //
                   1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1);
    BUILDER_FLOATS(&b, "MAT4", 2, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, //
                   1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1);
    builder_accessor(&b, UNSIGNED_BYTE_CODE, "VEC4", 3, first, sizeof first);
    BUILDER_FLOATS(&b, "VEC4", 3, 1, 0, 0, 0, 0.5f, 0.5f, 0, 0, 0, 1, 0, 0);
    builder_accessor(&b, UNSIGNED_SHORT_CODE, "VEC4", 3, second, sizeof second);
    builder_accessor(&b, UNSIGNED_SHORT_CODE, "VEC4,'normalized':true", 3, weights, sizeof weights);
    return b;
}

static bool load_skin(const struct gltf_builder *builder, const struct skin_file *file,
                      struct scene *scene, struct err *err)
{
    char lists[2048];
    snprintf(lists, sizeof lists,
             "'nodes':[%s],'skins':[{%s}],'meshes':[{'primitives':[{'attributes':{'POSITION':0,"
             "'NORMAL':1,'TANGENT':2,%s}}]}]%s",
             file->nodes, file->skin ? file->skin : "'joints':[1,2],'inverseBindMatrices':4",
             file->attributes ? file->attributes : "'JOINTS_0':5,'WEIGHTS_0':6",
             file->rest ? file->rest : "");
    return builder_load(
        builder, lists,
        &(struct gltf_load_params){.place = file->place, .at_seconds = file->seconds}, scene, err);
}

// The second joint, at x = 1, is rotated by a quarter turn about Z.
#define NODES                                                                                      \
    "{'mesh':0,'skin':0,'translation':[50,60,70]},{'translation':[10,0,0],'children':[2]},"        \
    "{'translation':[1,0,0],'rotation':[0,0,0.7071067811865476,0.7071067811865476]}"

TEST(two_joints)
{
    const struct gltf_builder builder = with_skin();
    struct scene scene;
    struct err err;
    bool ok = load_skin(&builder, &(struct skin_file){.nodes = NODES}, &scene, &err);
    CHECK(ok && scene.mesh_count == 1 && scene.instance_count == 1, "%s", err.msg);
    if (ok && scene.mesh_count == 1 && scene.instance_count == 1) {
        const struct mesh *mesh = &scene.meshes[0];
        const double root = sqrt(0.5);
        // The transform of the mesh's own node is ignored.
        CHECK(memcmp(scene.instances[0].transform, AFFINE_IDENTITY, sizeof(double[3][4])) == 0);
        CHECK(near3(mesh->positions[0], 10, 0, 0));
        // The joint's inverse bind matrix moves x = 1 to the joint's origin.
        CHECK(near3(mesh->positions[1], 11, 0, 0));
        // (2, 1) is (1, 1) relative to the joint, which rotates it to (-1, 1).
        CHECK(near3(mesh->positions[2], 10, 1, 0), "%g %g", (double)mesh->positions[2][0],
              (double)mesh->positions[2][1]);
        CHECK(near3(mesh->normals[0], 0, 0, 1) && near3(mesh->normals[1], -root, root, 0) &&
              near3(mesh->normals[2], 0, 1, 0));
        CHECK(near3(mesh->tangents[0], 1, 0, 0) && near3(mesh->tangents[1], root, root, 0) &&
              near3(mesh->tangents[2], -1, 0, 0) && mesh->tangents[2][3] == -1);
        CHECK(mesh->indices[0][0] == 0 && mesh->indices[0][1] == 1);
    }
    scene_finish(&scene);
}

// The sum of half of (2, 1, 0) moved by 10, and half of it scaled and moved by (11, 20). There are
// no bind matrices.
TEST(linear_blend)
{
    const struct gltf_builder builder = with_skin();
    struct scene scene;
    struct err err;
    bool ok = load_skin(&builder,
                        &(struct skin_file){
                            .nodes = "{'mesh':0,'skin':0},{'translation':[10,0,0]},"
                                     "{'translation':[11,20,0],'scale':[2,4,1]}",
                            .skin = "'joints':[1,2]",
                        },
                        &scene, &err);
    CHECK(ok, "%s", err.msg);
    if (ok) {
        const struct mesh *mesh = &scene.meshes[0];
        CHECK(near3(mesh->positions[1], (11 + 13) / 2.0, 10, 0));
        CHECK(near3(mesh->positions[2], 11 + 4, 24, 0));
        CHECK(mesh->exact_positions[1][0] == 12 && mesh->exact_positions[1][1] == 10);
        // The matrix is diag(1.5, 2.5, 1): the normal (0, 1, 0) keeps its direction.
        CHECK(near3(mesh->normals[1], 0, 1, 0));
    }
    scene_finish(&scene);
}

// The second set adds the weight 32768 / 65535 of joint 1 to the second vertex. All weights are
// divided by their sum.
TEST(second_set_of_weights)
{
    const struct gltf_builder builder = with_skin();
    struct scene scene;
    struct err err;
    bool ok = load_skin(&builder,
                        &(struct skin_file){
                            .nodes = "{'mesh':0,'skin':0},{},{'translation':[0,8,0]}",
                            .skin = "'joints':[1,2],'inverseBindMatrices':3",
                            .attributes = "'JOINTS_0':5,'WEIGHTS_0':6,'JOINTS_1':7,'WEIGHTS_1':8",
                        },
                        &scene, &err);
    CHECK(ok, "%s", err.msg);
    const double more = 32768 / 65535.0;
    if (ok)
        CHECK(near3(scene.meshes[0].positions[1], 1, 8 * (0.5 + more) / (1 + more), 0));
    scene_finish(&scene);
}

TEST(byte_weights)
{
    struct gltf_builder builder = with_skin();
    const uint8_t weights[3][4] = {{255}, {51, 204}, {0}};
    builder_accessor(&builder, UNSIGNED_BYTE_CODE, "VEC4,'normalized':true", 3, weights,
                     sizeof weights);
    struct scene scene;
    struct err err;
    bool ok = load_skin(&builder,
                        &(struct skin_file){
                            .nodes = "{'mesh':0,'skin':0},{'translation':[0,0,3]},"
                                     "{'translation':[0,10,0]}",
                            .skin = "'joints':[1,2]",
                            .attributes = "'JOINTS_0':5,'WEIGHTS_0':9",
                        },
                        &scene, &err);
    CHECK(ok, "%s", err.msg);
    if (ok) {
        CHECK(near3(scene.meshes[0].positions[1], 1, 8, 0.6));
        CHECK(near3(scene.meshes[0].positions[2], 2, 1, 3)); // a vertex without weights uses the
                                                             // first joint
        CHECK(has_note(&scene, "1 vertices without weights follow their skin's first joint"));
    }
    scene_finish(&scene);
}

// A joint that reflects changes the orientation of the triangle and the sign of the bitangent.
TEST(reflected_joint)
{
    const struct gltf_builder builder = with_skin();
    struct scene scene;
    struct err err;
    bool ok = load_skin(&builder,
                        &(struct skin_file){
                            .nodes = "{'mesh':0,'skin':0},{'scale':[1,-1,1]},{'scale':[1,-1,1]}",
                            .skin = "'joints':[1,2]",
                        },
                        &scene, &err);
    CHECK(ok, "%s", err.msg);
    if (ok) {
        const struct mesh *mesh = &scene.meshes[0];
        CHECK(near3(mesh->positions[2], 2, -1, 0) && near3(mesh->normals[0], 0, 0, 1) &&
              near3(mesh->normals[1], 0, -1, 0) && near3(mesh->tangents[2], 0, -1, 0));
        CHECK(mesh->tangents[0][3] == -1 && mesh->tangents[2][3] == 1);
        CHECK(mesh->indices[0][0] == 0 && mesh->indices[0][1] == 2 && mesh->indices[0][2] == 1);
    }
    scene_finish(&scene);
}

TEST(placed_in_another_world)
{
    static const double place[3][4] = {{0, 0, 2, 5}, {2, 0, 0, 6}, {0, 2, 0, 7}};
    const struct gltf_builder builder = with_skin();
    struct scene scene;
    struct err err;
    bool ok =
        load_skin(&builder, &(struct skin_file){.nodes = NODES, .place = place}, &scene, &err);
    CHECK(ok, "%s", err.msg);
    if (ok)
        CHECK(near3(scene.meshes[0].positions[2], 5, 6 + 20, 7 + 2) &&
              near3(scene.meshes[0].normals[0], 1, 0, 0));
    scene_finish(&scene);
}

// Two nodes have the same mesh with different skins, and one has it without a skin.
TEST(one_mesh_with_two_skins)
{
    const struct gltf_builder builder = with_skin();
    struct scene scene;
    struct err err;
    bool ok = load_skin(&builder,
                        &(struct skin_file){
                            .nodes = "{'mesh':0,'skin':0},{'translation':[1,0,0]},"
                                     "{'translation':[2,0,0]},{'mesh':0,'skin':1},{'mesh':0},"
                                     "{'mesh':0}",
                            .skin = "'joints':[1,1]},{'joints':[2,2]",
                        },
                        &scene, &err);
    CHECK(ok && scene.mesh_count == 3 && scene.instance_count == 4, "%u meshes: %s",
          scene.mesh_count, err.msg);
    if (ok && scene.mesh_count == 3)
        CHECK(near3(scene.meshes[0].positions[0], 1, 0, 0) &&
              near3(scene.meshes[1].positions[0], 2, 0, 0) &&
              near3(scene.meshes[2].positions[0], 0, 0, 0) && !scene.meshes[2].exact_positions &&
              scene.instances[2].mesh == 2 && scene.instances[3].mesh == 2);
    scene_finish(&scene);
}

// Morph targets are applied first, then joints, which an animation moves.
TEST(morphed_and_animated)
{
    struct gltf_builder builder = with_skin();
    double seconds = 1;
    BUILDER_FLOATS(&builder, "VEC3", 3, 0, 0, 0, 0, 0, 0, 0, 4, 0);
    BUILDER_FLOATS(&builder, "SCALAR", 2, 0, 2);
    BUILDER_FLOATS(&builder, "VEC3", 2, 0, 0, 0, 0, 0, 6);
    struct scene scene;
    struct err err;
    bool ok = builder_load(
        &builder,
        "'nodes':[{'mesh':0,'skin':0},{},{}],'skins':[{'joints':[1,2]}],"
        "'meshes':[{'weights':[0.5],'primitives':[{'attributes':{'POSITION':0,'JOINTS_0':5,"
        "'WEIGHTS_0':6},'targets':[{'POSITION':9}]}]}],"
        "'animations':[{'samplers':[{'input':10,'output':11}],'channels':[{'sampler':0,"
        "'target':{'node':2,'path':'translation'}}]}]",
        &(struct gltf_load_params){.at_seconds = &seconds}, &scene, &err);
    CHECK(ok, "%s", err.msg);
    if (ok)
        CHECK(near3(scene.meshes[0].positions[2], 2, 3, 3) &&
              near3(scene.meshes[0].positions[1], 1, 0, 1.5) && !scene.meshes[0].normals);
    scene_finish(&scene);
}

TEST(notes)
{
    struct gltf_builder builder = with_skin();
    BUILDER_FLOATS(&builder, "MAT4", 2, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, //
                   1, 0, 0, 9, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2);
    struct scene scene;
    struct err err;
    bool ok = load_skin(
        &builder,
        &(struct skin_file){
            .nodes = "{'mesh':0,'skin':0,'extensions':{'EXT_mesh_gpu_instancing':{}}},{},{}",
            .skin = "'joints':[1,2],'skeleton':1,'inverseBindMatrices':9",
        },
        &scene, &err);
    CHECK(ok, "%s", err.msg);
    CHECK(has_note(&scene, "1 skinned nodes are shown once") &&
          has_note(&scene, "1 inverse bind matrices have a last row"));
    if (ok)
        CHECK(near3(scene.meshes[0].positions[2], 2, 1, 0));
    scene_finish(&scene);
}

// A node may be a joint of its own skin; this is not a cycle.
TEST(own_joint)
{
    const struct gltf_builder builder = with_skin();
    struct scene scene;
    struct err err;
    bool ok = load_skin(&builder,
                        &(struct skin_file){.nodes = "{'mesh':0,'skin':0,'translation':[0,3,0],"
                                                     "'children':[1]},{'mesh':0,'skin':0}",
                                            .skin = "'joints':[0,1]"},
                        &scene, &err);
    CHECK(ok && scene.mesh_count == 2, "%s", err.msg);
    if (ok)
        CHECK(near3(scene.meshes[0].positions[0], 0, 3, 0) &&
              near3(scene.meshes[1].positions[0], 0, 3, 0));
    scene_finish(&scene);
}

static void check_rejected(const struct skin_file *file, const char *message)
{
    struct gltf_builder builder = with_skin();
    const uint8_t joints[3][4] = {{0}, {0, 0, 2}, {0}}, bytes[3][4] = {{255}, {255}, {255}};
    const uint8_t two[2][4] = {{0}, {0}};
    builder_accessor(&builder, UNSIGNED_BYTE_CODE, "VEC4", 3, joints, sizeof joints); // accessor 9
    builder_accessor(&builder, UNSIGNED_BYTE_CODE, "VEC4", 3, bytes, sizeof bytes);   // accessor 10
    builder_accessor(&builder, UNSIGNED_BYTE_CODE, "VEC4", 2, two, sizeof two);       // accessor 11
    BUILDER_FLOATS(&builder, "VEC4", 3, 1, 0, 0, 0, 0, -1, 2, 0, 1, 0, 0, 0);         // accessor 12
    BUILDER_FLOATS(&builder, "VEC4", 3, 1, 0, 0, 0, 0, 0, 0, NAN, 1, 0, 0, 0);        // accessor 13
    BUILDER_FLOATS(&builder, "MAT4", 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0,
                   1); // accessor 14
    struct scene scene;
    struct err err;
    bool ok = load_skin(&builder, file, &scene, &err);
    CHECK(!ok && err.code == ERR_INPUT && strstr(err.msg, message), "%s: %s", message,
          ok ? "loaded" : err.msg);
    scene_finish(&scene);
}

#define SKIN(text) (&(struct skin_file){.nodes = NODES, .skin = text})
#define WITH(text) (&(struct skin_file){.nodes = NODES, .attributes = text})

TEST(bad_skins)
{
    check_rejected(SKIN("'x':0"), "skins[0]: \"joints\" is missing");
    check_rejected(SKIN("'joints':[]"), "skins[0].joints: 0 elements");
    check_rejected(SKIN("'joints':7"), "skins[0].joints: expected an array");
    check_rejected(SKIN("'joints':[1,'a']"), "skins[0].joints[1]: expected the index of a node");
    check_rejected(SKIN("'joints':[1,3]"), "skins[0].joints[1]: 3; expected the index of a node");
    check_rejected(SKIN("'joints':[1,-1]"), "skins[0].joints[1]: -1; ");
    check_rejected(SKIN("'joints':[1,2],'skeleton':3"), "skins[0].skeleton: 3; expected an index");
    check_rejected(SKIN("'joints':[1,2],'inverseBindMatrices':15"),
                   "skins[0].inverseBindMatrices: 15; expected an index below 15");
    check_rejected(SKIN("'joints':[1,2],'inverseBindMatrices':14"),
                   "accessors[14]: 1 inverse bind matrices for 2 joints");
    check_rejected(SKIN("'joints':[1,2],'inverseBindMatrices':6"),
                   "accessors[6].type: \"VEC4\"; expected \"MAT4\" for inverse bind matrices");
    check_rejected(&(struct skin_file){.nodes = "{'mesh':0,'skin':1},{},{}"},
                   "nodes[0].skin: 1; expected an index below 1");
    check_rejected(&(struct skin_file){.nodes = NODES, .rest = ",'scenes':[{'nodes':[0]}]"},
                   "skins[0].joints[0]: node 1 is not in the scene that is loaded");
    check_rejected(&(struct skin_file){.nodes = "{'mesh':0,'skin':0},{'scale':[1e200,1,1],"
                                                "'translation':[0,0,1e300]},{}"},
                   "meshes[0].primitives[0]: vertex 0: its joints bring it to ");
}

TEST(bad_weights)
{
    check_rejected(WITH("'x':0"), "meshes[0].primitives[0].attributes: \"JOINTS_0\" is missing");
    check_rejected(WITH("'JOINTS_0':5"), "attributes: \"WEIGHTS_0\" is missing");
    check_rejected(WITH("'JOINTS_0':5,'WEIGHTS_0':6,'JOINTS_1':7"), "\"WEIGHTS_1\" is missing");
    check_rejected(WITH("'JOINTS_0':99,'WEIGHTS_0':6"), "attributes.JOINTS_0: 99; expected");
    check_rejected(WITH("'JOINTS_0':5,'WEIGHTS_0':99"), "attributes.WEIGHTS_0: 99; expected");
    check_rejected(WITH("'JOINTS_0':9,'WEIGHTS_0':6"),
                   "accessors[9]: element 1, component 2 is 2; expected an index below the number "
                   "of joints, 2");
    check_rejected(WITH("'JOINTS_0':6,'WEIGHTS_0':6"),
                   "accessors[6].componentType: 5126 (FLOAT) is not allowed for JOINTS");
    check_rejected(WITH("'JOINTS_0':5,'WEIGHTS_0':10"),
                   "accessors[10].componentType: 5121 (UNSIGNED_BYTE) is not allowed for WEIGHTS");
    check_rejected(WITH("'JOINTS_0':11,'WEIGHTS_0':6"),
                   "accessors[11]: 2 elements of JOINTS for 3 positions");
    check_rejected(WITH("'JOINTS_0':5,'WEIGHTS_0':12"),
                   "accessors[12]: element 1, component 1 is -1; expected no negative weight");
    check_rejected(WITH("'JOINTS_0':5,'WEIGHTS_0':13"),
                   "accessors[13]: element 1, component 3 is nan");
    check_rejected(WITH("'JOINTS_0':0,'WEIGHTS_0':6"), "\"VEC3\"; expected \"VEC4\" for JOINTS");
}

TEST_MAIN(TEST_CASE(two_joints), TEST_CASE(linear_blend), TEST_CASE(second_set_of_weights),
          TEST_CASE(byte_weights), TEST_CASE(reflected_joint), TEST_CASE(placed_in_another_world),
          TEST_CASE(one_mesh_with_two_skins), TEST_CASE(morphed_and_animated), TEST_CASE(notes),
          TEST_CASE(own_joint), TEST_CASE(bad_skins), TEST_CASE(bad_weights))
