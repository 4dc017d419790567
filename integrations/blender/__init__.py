"""brio in Blender: Object > brio makes surfaces and hulls of the vertices of the active object.

    Surface from Points     the surface that the vertices are samples of, with its certificate in the status line
    Exact Convex Hull       the hull of the vertices

The result is a new object in the same place, with the same collection. brio itself comes in the extension's wheels."""
import bpy
import numpy as np


def points_of(obj):
    """The vertices of an object's mesh in its own coordinates, as rows of numbers."""
    rows = np.empty(3 * len(obj.data.vertices), np.float32)
    obj.data.vertices.foreach_get("co", rows)
    return rows.reshape(-1, 3).astype(np.float64)


def make_object(context, source, name, vertices, faces):
    """Adds an object of polygons, `faces` lists of vertices, beside its source."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices.tolist(), [], [list(map(int, face)) for face in faces])
    mesh.update()
    made = bpy.data.objects.new(name, mesh)
    made.matrix_world = source.matrix_world.copy()
    (source.users_collection or [context.scene.collection])[0].objects.link(made)
    return made


class _Operator(bpy.types.Operator):
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return context.object is not None and context.object.type == "MESH" and context.mode == "OBJECT"

    def execute(self, context):
        import brio

        source = context.object
        try:
            name, vertices, faces, words = self.work(brio, points_of(source))
        except brio.Error as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        make_object(context, source, source.name + "." + name, vertices, faces)
        self.report({"INFO"}, words)
        return {"FINISHED"}


class BrioSurface(_Operator):
    """Reconstruct the surface that the vertices are samples of"""

    bl_idname = "object.brio_surface"
    bl_label = "Surface from Points"

    method: bpy.props.EnumProperty(name="Method", default="labeled-delaunay", items=[
        ("labeled-delaunay", "Labeled Delaunay", "Triangles of the samples, with holes where the samples end"),
        ("power-crust", "Power crust", "Closed, of polygons"), ("tight-cocone", "Tight cocone", "Closed, of the samples")])
    outliers: bpy.props.BoolProperty(name="Leave out outliers", description="Vertices far from all others", default=False)

    def work(self, brio, rows):
        if self.outliers:
            rows = rows[~brio.outliers(rows)]
        found = brio.reconstruct(rows, self.method)
        certificate = found.certificate
        words = "%d faces, %s, genus %d, %d components" % (len(found.face_offsets) - 1, "closed" if certificate.closed else "open",
                                                          certificate.genus, certificate.components)
        return "surface", np.asarray(found.vertices), np.split(np.asarray(found.face_vertices), np.asarray(found.face_offsets)[1:-1]), words


class BrioHull(_Operator):
    """Make the convex hull of the vertices, exactly"""

    bl_idname = "object.brio_hull"
    bl_label = "Exact Convex Hull"

    def work(self, brio, rows):
        found = brio.ConvexHull(rows)
        used, faces = np.unique(np.asarray(found.simplices), return_inverse=True)
        return "hull", rows[used], faces.reshape(-1, 3), "volume %g, area %g" % (found.volume, found.area)


class BrioMenu(bpy.types.Menu):
    bl_idname = "OBJECT_MT_brio"
    bl_label = "brio"

    def draw(self, context):
        self.layout.operator(BrioSurface.bl_idname)
        self.layout.operator(BrioHull.bl_idname)


CLASSES = (BrioSurface, BrioHull, BrioMenu)


def _entry(menu, context):
    menu.layout.menu(BrioMenu.bl_idname)


def register():
    for kind in CLASSES:
        bpy.utils.register_class(kind)
    if hasattr(bpy.types, "VIEW3D_MT_object"):
        bpy.types.VIEW3D_MT_object.append(_entry)


def unregister():
    if hasattr(bpy.types, "VIEW3D_MT_object"):
        bpy.types.VIEW3D_MT_object.remove(_entry)
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
