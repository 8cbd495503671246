"""The sizes of the ensembles stand in the configuration, where a user looks, and in the wing, for whoever runs it without one."""

from robins.papers import all_papers, configuration


def test_the_configuration_and_the_wing_name_the_same_sizes(repository):
    loaded = configuration.load(repository / "config" / "config.yaml", {})
    paper = all_papers()["hajiyev2023"]
    assert configuration.settings_for(paper, loaded).sizes == paper.sizes["standard"]


def test_the_standard_ensemble_is_at_least_what_the_brief_demands():
    sizes = all_papers()["hajiyev2023"].sizes["standard"]
    assert (sizes["runs"], sizes["sweep_runs"], sizes["specification_sets"], sizes["specification_runs"]) == (1000, 100, 300, 30)


def test_the_small_ensemble_has_at_least_eight_runs_of_everything():
    sizes = all_papers()["hajiyev2023"].sizes["smoke"]
    assert min(sizes[name] for name in ("runs", "sweep_runs", "specification_sets", "specification_runs")) >= 8
