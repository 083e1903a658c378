//! What makers of maps other than OpenStreetMap call things, as its tags.
//!
//! Natural Earth (naturalearthdata.com) has `featurecla`; Geofabrik's shapefiles of OpenStreetMap have `fclass`, and with
//! it `type` for a building (F. Ramm, OpenStreetMap Data in Layered GIS Format, 2022). What is in neither table has no tag
//! and is of no kind that is drawn.

use super::raw::Tags;

/// Adds the tag of Natural Earth's class.
pub fn natural_earth(tags: &mut Tags, key: &str, value: &str) {
    if key != "featurecla" {
        return;
    }
    match value {
        "River" | "Lake Centerline" | "Canal" => {
            tags.push("waterway", if value == "Canal" { "canal" } else { "river" })
        }
        "Road" => tags.push("highway", "primary"),
        "Railroad" => tags.push("railway", "rail"),
        "Urban area" => tags.push("landuse", "residential"),
        "Glaciated areas" => tags.push("natural", "glacier"),
        "Lake" | "Alkaline Lake" | "Reservoir" => tags.push("natural", "water"),
        _ => {}
    }
}

/// Adds the tags of Geofabrik's class; `area` is whether the shape is one, since a residential road and a residential
/// area are called the same.
pub fn geofabrik(tags: &mut Tags, area: bool) {
    let Some(class) = tags.get("fclass").map(str::to_owned) else { return };
    let (key, value) = match class.as_str() {
        "forest" | "residential" | "industrial" | "commercial" | "retail" | "farmland" | "farmyard" | "meadow"
        | "grass" | "orchard" | "vineyard" | "allotments" | "cemetery" | "recreation_ground" | "quarry"
            if area =>
        {
            ("landuse", class.as_str())
        }
        "park" => ("leisure", "park"),
        "scrub" | "heath" | "glacier" | "beach" => ("natural", class.as_str()),
        "water" | "reservoir" => ("natural", "water"),
        "river" | "riverbank" if area => ("waterway", "riverbank"),
        "dock" => ("waterway", "dock"),
        "river" | "stream" | "canal" | "drain" => ("waterway", class.as_str()),
        "building" => {
            let kind = tags.get("type").unwrap_or("yes").to_owned();
            tags.push("building", &kind);
            return;
        }
        "rail" | "light_rail" | "subway" | "tram" | "monorail" | "narrow_gauge" | "funicular" | "rack" => {
            ("railway", class.as_str())
        }
        "parking" if area => ("amenity", "parking"),
        "apron" | "helipad" => ("aeroway", class.as_str()),
        "motorway" | "trunk" | "primary" | "secondary" | "tertiary" | "motorway_link" | "trunk_link"
        | "primary_link" | "secondary_link" | "tertiary_link" | "unclassified" | "residential" | "living_street"
        | "pedestrian" | "busway" | "service" | "track" | "path" | "footway" | "cycleway" | "bridleway" | "steps"
            if !area =>
        {
            ("highway", class.as_str())
        }
        "track_grade1" | "track_grade2" | "track_grade3" | "track_grade4" | "track_grade5" if !area => {
            tags.push("highway", "track");
            ("tracktype", &class["track_".len()..])
        }
        _ => return,
    };
    tags.push(key, value);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_class_means_what_its_shape_lets_it() {
        let told = |class: &str, area: bool, key: &str| {
            let mut tags = Tags::default();
            tags.push("fclass", class);
            geofabrik(&mut tags, area);
            tags.get(key).map(str::to_owned)
        };
        assert_eq!(told("residential", true, "landuse").as_deref(), Some("residential"));
        assert_eq!(told("residential", true, "highway"), None);
        assert_eq!(told("residential", false, "highway").as_deref(), Some("residential"));
        assert_eq!(told("river", false, "waterway").as_deref(), Some("river"));
        assert_eq!(told("river", true, "waterway").as_deref(), Some("riverbank"));
        assert_eq!(told("track_grade3", false, "tracktype").as_deref(), Some("grade3"));
        assert_eq!(told("building", true, "building").as_deref(), Some("yes"));
        assert_eq!(told("military", true, "landuse"), None);
    }
}
