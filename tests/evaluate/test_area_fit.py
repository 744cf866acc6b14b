import numpy as np
import pytest

from panokit.evaluate.area_fit import AreaRecord, area_record, fit_rules
from panokit.evaluate.probe_set import find_probes
from panokit.evaluate.scoring import take_picture
from panokit.expand.baselines import SHIPPED_AREA_RULE


def made_by(offset: float, slope: float, *, fold: int, count: int = 30) -> list[AreaRecord]:
    """Pictures of a world in which the rule with these numbers is the truth."""
    random = np.random.default_rng(fold)
    records = []
    for _ in range(count):
        log_area = random.uniform(-8, -1, 3)
        received = random.uniform(0, 0.2, (3, 6))
        rest = random.uniform(0.5, 1, 6)
        true = rest + np.exp(offset + slope * log_area) @ received
        records.append(
            AreaRecord(
                fold=fold,
                log_area=tuple(log_area),
                received=tuple(map(tuple, received)),
                rest=tuple(rest),
                true=tuple(true),
            )
        )
    return records


def test_a_fold_gets_the_rule_of_the_others():
    records = made_by(0.5, -0.3, fold=0) + made_by(1.2, -0.1, fold=1)
    rules = fit_rules(records, [0, 1, 0, 1])
    assert (rules[1].offset, rules[1].slope) == pytest.approx((0.5, -0.3), abs=0.02)
    assert (rules[0].offset, rules[0].slope) == pytest.approx((1.2, -0.1), abs=0.02)


def test_with_few_pictures_the_shipped_rule_stands_in():
    records = made_by(0.5, -0.3, fold=0, count=4)
    assert fit_rules(records, [0, 1]) == {0: SHIPPED_AREA_RULE, 1: SHIPPED_AREA_RULE}


def test_a_record_adds_up_to_the_picture(probe_folder):
    probe = find_probes(probe_folder)[3]
    picture = take_picture(probe, probe.radiance(), "A", index=3, fold=2)
    record = area_record(picture.pixels, picture.truth, picture.fold)
    assert record.fold == 2
    assert len(record.log_area) == len(record.received) >= 1
    lit = np.sum(record.received, axis=0) + record.rest
    # The lamp is brighter than the picture shows, everything else is as it is.
    assert (lit <= np.array(record.true) * 1.02).all()
    assert (np.array(record.true) / lit).max() > 1.2
