"""A processing script of QGIS: the terrain of a scan, as a raster of heights and as triangles, by the program brio.

Install: Processing > Toolbox > Scripts > Add Script to Toolbox. The program is that of the setting BRIO in the environment, or brio in the
path. It takes LAS, LAZ, PLY, XYZ and all else that brio reads; triangles that are longer than the greatest edge are left out."""
import json
import os
import subprocess

from qgis.core import (QgsProcessingAlgorithm, QgsProcessingException, QgsProcessingOutputNumber, QgsProcessingParameterFile,
                       QgsProcessingParameterFileDestination, QgsProcessingParameterNumber, QgsProcessingParameterRasterDestination,
                       QgsProcessingParameterString)


def command_of(program, cloud, raster, cell, classes="", max_edge=0.0, mesh=""):
    """The words that run the program."""
    words = [program, "terrain", cloud, "--raster", raster, "--cell", repr(float(cell)), "--json"]
    if classes:
        words += ["--class", classes]
    if max_edge > 0:
        words += ["--max-edge", repr(float(max_edge))]
    if mesh:
        words += ["-o", mesh]
    return words


class BrioTerrain(QgsProcessingAlgorithm):
    """Points, classes, size of cells: a GeoTIFF of heights."""

    CLOUD, CLASSES, CELL, MAX_EDGE, RASTER, MESH, TRIANGLES = "CLOUD", "CLASSES", "CELL", "MAX_EDGE", "RASTER", "MESH", "TRIANGLES"

    def createInstance(self):  # noqa: N802: names of QGIS
        return BrioTerrain()

    def name(self):
        return "brioterrain"

    def displayName(self):  # noqa: N802
        return "Terrain of a scan (brio)"

    def group(self):
        return "Terrain"

    def groupId(self):  # noqa: N802
        return "terrain"

    def shortHelpString(self):  # noqa: N802
        return "Triangulates points over the map, exactly, and writes the heights of cells. Class 2 is ground in LAS files."

    def initAlgorithm(self, configuration=None):  # noqa: N802
        self.addParameter(QgsProcessingParameterFile(self.CLOUD, "Points"))
        self.addParameter(QgsProcessingParameterString(self.CLASSES, "Classes, such as 2,8; all where it is empty", "", optional=True))
        self.addParameter(QgsProcessingParameterNumber(self.CELL, "Side of a cell", QgsProcessingParameterNumber.Double, 1.0, minValue=1e-9))
        self.addParameter(QgsProcessingParameterNumber(self.MAX_EDGE, "Greatest edge on the map; 0 for any",
                                                       QgsProcessingParameterNumber.Double, 0.0, minValue=0.0))
        self.addParameter(QgsProcessingParameterRasterDestination(self.RASTER, "Heights"))
        self.addParameter(QgsProcessingParameterFileDestination(self.MESH, "Triangles", "PLY (*.ply)", optional=True, createByDefault=False))
        self.addOutput(QgsProcessingOutputNumber(self.TRIANGLES, "Number of triangles"))

    def processAlgorithm(self, parameters, context, feedback):  # noqa: N802
        raster = self.parameterAsOutputLayer(parameters, self.RASTER, context)
        mesh = self.parameterAsFileOutput(parameters, self.MESH, context)
        words = command_of(os.environ.get("BRIO", "brio"), self.parameterAsFile(parameters, self.CLOUD, context), raster,
                           self.parameterAsDouble(parameters, self.CELL, context),
                           self.parameterAsString(parameters, self.CLASSES, context),
                           self.parameterAsDouble(parameters, self.MAX_EDGE, context), mesh)
        feedback.pushInfo(" ".join(words))
        report = self._run(words, feedback)
        return {self.RASTER: raster, self.MESH: mesh or None, self.TRIANGLES: report.get("faces", report.get("triangles"))}

    @staticmethod
    def _run(words, feedback):
        """Runs the program, which stops when the user does. Returns its report."""
        try:
            process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        except OSError as error:
            raise QgsProcessingException("%s: %s; set BRIO to the program brio" % (words[0], error)) from error
        while True:
            try:
                out, err = process.communicate(timeout=0.2)
                break
            except subprocess.TimeoutExpired:
                if feedback.isCanceled():
                    process.terminate()
        if process.returncode:
            raise QgsProcessingException(err.strip() or "brio ended with status %d" % process.returncode)
        return json.loads(out)
