"""Threads of brio beside those of torch, Open3D and scikit-learn, whichever are there, in one process, and after fork."""

import os

import numpy as np

points = np.random.default_rng(1).random((50_000, 3))


def work_of(module):
    if module == "torch":
        import torch

        return lambda: (torch.from_numpy(points) @ torch.from_numpy(points[:200].T.copy())).sum().item()
    if module == "open3d":
        import open3d

        cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(points))
        return lambda: cloud.estimate_normals()
    from sklearn.cluster import KMeans

    return lambda: KMeans(5, n_init=1, random_state=1).fit(points)


def main():
    works = []
    for module in ("torch", "open3d", "sklearn"):
        try:
            works.append(work_of(module))
            print("with", module)
        except ImportError as error:
            print("skipped: no %s: %s" % (module, error))
    import brio

    first = brio.Delaunay(points).checksum
    for work in works:
        work()
        assert brio.Delaunay(points, threads=4).checksum == first
        work()
    try:
        import torch

        tensor = torch.from_numpy(points)
        assert brio.Delaunay(tensor).checksum == first and brio.Delaunay(tensor.requires_grad_()).checksum == first
    except ImportError:
        pass
    child = os.fork()
    if not child:
        os._exit(brio.Delaunay(points, threads=4).checksum != first)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    print("done")


if __name__ == "__main__":
    main()
