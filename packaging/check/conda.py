"""conda.py RECIPE OUT PLATFORM ...: reads a recipe for each platform by rattler-build, and builds it for the first with its tests, with
empty packages in place of those that it asks for."""
import pathlib
import sys

from rattler_build import PlatformConfig, RenderConfig, Stage0Recipe, VariantConfig, assemble_package, build_recipes

folder, out, platforms = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3:]
asked = []
for platform in platforms:
    config = RenderConfig(platform=PlatformConfig(target_platform=platform, build_platform=platforms[0], host_platform=platform))
    (variant,) = Stage0Recipe.from_file(folder / 'recipe.yaml').render(VariantConfig(), config)
    needs = variant.recipe.requirements.to_dict()
    asked = asked or needs['build'] + needs['host']
    print(platform, needs)
channel = out / 'built'  # whose packages rattler-build lists itself
for need in asked:
    name, _, version = need.partition(' ')
    assemble_package(name, version.lstrip('>=') or '1.0', platforms[0], '0', channel / platforms[0])
(channel / 'noarch').mkdir(exist_ok=True)
build_recipes([folder / 'recipe.yaml'], channel=[channel.as_uri()], output_dir=out / 'built', test='native', target_platform=platforms[0])
(package,) = (out / 'built' / platforms[0]).glob('brio-*.conda')
print('read for %s; built for %s, %d bytes, its tests passed' % (', '.join(platforms), platforms[0], package.stat().st_size))
